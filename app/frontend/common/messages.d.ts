// Written by app/widgets/protocol.py.
type Vector = number[]
type Camera = {position: Vector; focal_point: Vector}
type Cut = {origin: Vector; normal: Vector}
type Images = {count: number; side: number; pixels?: Uint8Array}
type Legend = Record<'title' | 'low' | 'high', string> & {table: Uint8Array | null; swatches: [string, string][]}
type Theme = Record<'top' | 'bottom' | 'ink' | 'card' | 'paper', string>
type Bones = {names: string[]} & Record<'start' | 'end' | 'joint', Iterable<number>>
type Rings = {joint: number; joints: number} & Record<'centre' | 'below', Iterable<number>>
type Knob = {joint: number; at: Iterable<number>; mirror: Iterable<number> | null}
type Brush = {radius: number; mirror: Iterable<number> | null}
type Motion = {times: Float32Array; matrices: Float32Array}
type Wave = {seconds: number; end: number}
type Skin = {joints: Uint16Array; weights: Float32Array; count: number}
type Painted = Partial<Skin> & {gone?: boolean; vertices?: Uint32Array; colors?: Uint8Array; scalars?: Float32Array}
type Paint = Record<'opacity' | 'width' | 'thick' | 'dash' | 'ambient' | 'diffuse', number> & Record<'behind' | 'closed' | 'hull' | 'edges' | 'coloured', boolean> & {color: Vector; form: string}
type Reading = {text: string; values: Float32Array | null; names: string[]; percent: boolean; unit: number}
type Part = Partial<{kind: string; points: Float32Array; normals: Float32Array; cells: Uint32Array; skin: Skin | null; apart: Skin & {unit: number} | null; colors: Uint8Array; scalars: Float32Array; table: Uint8Array; limits: number[]; materials: {corners: Float32Array; tints: Uint8Array}; paint: Paint; place: {overlay: boolean; view: number | null}; visible: boolean; animation: boolean; reading: Reading | null; clipped: boolean; slab: number}>
type FromBrowser =
  | {type: 'ready'; width: number; dark: string | null; calm: boolean; pictures: boolean}  // The view is there.
  | {type: 'camera'; home: boolean; position: Vector; focal_point: Vector; aspect: number; height?: number}  // The view rests.
  | {type: 'time'; time: number}  // Time of the motion.
  | {type: 'pick'; joint: number}  // A joint is clicked.
  | {type: 'pick-vertex'; vertex: number; view: number}  // A vertex is clicked in a view.
  | {type: 'pick-node'; node: number}  // A node of the graph is clicked.
  | {type: 'turn'; joint: number; axis: number; degrees: number; begin: boolean}  // A ring is dragged.
  | {type: 'joint'; joint: number; position: Vector; done: boolean}  // A joint is dragged.
  | {type: 'cut'; origin: Vector; normal: Vector}  // The plane is dragged.
  | {type: 'brush'; points?: number[]; first?: boolean; mode?: string | null; done?: boolean; cancelled?: boolean}  // A piece of a stroke, or its end.
  | {type: 'lasso'; vertices: number[]; mode: string}  // A line was drawn around vertices.
  | {type: 'strongest'; vertex: number}  // The strongest bone at a vertex is to be chosen.
  | {type: 'front'; front: number}  // The wavefront is halted.
  | {type: 'play'; on: boolean}  // The motion is played or paused.
  | {type: 'act'; act: string}  // A key is pressed.
  | {type: 'visit'; query: string}  // The browser goes back or forward.
  | {type: 'frame'; count: number; size: number[]; ratio: number; fine: boolean; position: Vector; focal_point: Vector; centre: number[]; tiles: number[][]}  // A picture is wanted.
  | {type: 'idle?'; number: number}  // A test wants to know when no work is left.
  | {type: 'upload-begin'; files: {name: string; size: number}[]}  // Files follow.
  | {type: 'upload-piece'; index: number; data: ArrayBuffer}  // A part of a file.
  | {type: 'upload-end'}  // All files are sent.
  | {type: 'upload-cancel'; unreadable?: boolean}  // The upload ends without its files.
type FromWidgets =
  | {type: 'close'}  // The card of a vertex is closed.
  | {type: 'explain'}  // Its explanation is shown or hidden.
  | {type: 'part'}  // Its part of the mesh is shown alone.
  | {type: 'overrule'; weights: number[][] | null}  // Its weights are given; null: computed.
  | {type: 'node'; node: number}  // A neighbour of a node is chosen.
  | {type: 'bone'; joint: number}  // A bone of the card is chosen.
  | {type: 'choose'; joint: number}  // A joint of the tree is chosen.
  | {type: 'carry'; joint: number; on: boolean}  // A joint may deform the mesh or not.
  | {type: 'step'; step: number}  // A step of the lesson is shown.
  | {type: 'answer'; value: string | number}  // A person answers the step.
  | {type: 'offer'; index: number}  // A button of the step is pressed.
  | {type: 'choose-value'; name: string; value: any}  // A number in the step's text is changed.
  | {type: 'stage'; on: boolean}  // The lesson is presented or not.
  | {type: 'row'; row: number}  // A row is chosen.
  | {type: 'row-point'; row: number}  // The pointer comes to a row; -1: it leaves.
  | {type: 'sort'; sort: number}  // A heading of the table of weights is clicked.
  | {type: 'page'; page: number}  // Another page of it is wanted.
  | {type: 'row-vertex'; vertex: number}  // The vertex of a row is clicked.
  | {type: 'edit'; vertex: number; column: number; value: number}  // A weight is edited.
  | {type: 'bars'; first: number; last: number}  // Bars of the histogram are chosen.
  | {type: 'point'; id: string}  // A point of a curve is chosen.
  | {type: 'method'; id: string; on: boolean}  // A method is shown or not.
interface ToBrowser {
  id?: number  // Number of the message.
  actors?: Record<string, Part>  // Parts of actors that changed, by name.
  remove?: string[]  // Names of actors.
  cut?: Cut | null  // The plane that cuts.
  front?: number | null  // The wavefront's distance.
  images?: Images | null  // Images of materials.
  legend?: Legend | null  // Colours and what they mean.
  views?: string[]  // Captions of the views.
  pose?: Float32Array | null  // Matrices of the joints.
  blending?: 'linear' | 'dual'  // Matrices or dual quaternions.
  lights?: [Vector, number][]  // Positions and intensities.
  theme?: Theme  // Colours of the overlay.
  dark?: boolean  // To be remembered.
  camera?: Camera & {now?: Camera | null}  // The initial view, and the view now.
  home?: boolean  // Go to the initial view.
  bones?: Bones  // Segments, their joints and names.
  gizmo?: Rings | null  // The rings.
  mover?: Knob | null  // The joint's knob.
  handles?: {box: Vector[]} | null  // The plane's knobs.
  brush?: Brush | null  // The brush.
  lasso?: {through: boolean} | null  // The lasso.
  clip?: Motion | null  // A motion.
  playing?: boolean  // Whether it runs.
  animation?: Wave | null  // A running wavefront.
  address?: string  // The page's address.
  link?: string  // What to copy: without the step of the lesson on panels of no step.
  able?: boolean[]  // Keys that do something.
  rendered?: boolean  // Whether PyVista draws the view that rests.
  frame?: {count: number; picture: ArrayBuffer}  // A picture.
  painted?: Painted  // What a stroke changed.
  idle?: number  // The number of a question: no work is left.
  upload?: {ok: boolean; message?: string}  // What becomes of an upload.
  copy?: {text: string; what: string}  // A text for the clipboard, and its kind.
  download?: {name: string; content: ArrayBuffer}  // A file to save.
}
