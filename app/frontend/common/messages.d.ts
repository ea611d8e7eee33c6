// Written by app/server/protocol/typescript.py.
type Vector = number[]
type Announced = {name: string; size: number}  // A file that follows.
type Camera = {position: Vector; focal_point: Vector}  // Where one looks from, and at what.
type Cameras = {position: Vector; focal_point: Vector; now?: Camera | null}  // The initial view, and the view now.
type Cut = {origin: Vector; normal: Vector}  // The plane that cuts.
type Images = {count: number; side: number; pixels: Uint8Array}  // Images of materials.
type Legend = {title: string; low: string; high: string; table: Uint8Array | null; swatches: [string, string][]}  // Colours and what they mean.
type Theme = {top: string; bottom: string; ink: string; card: string; paper: string}  // Colours of the overlay.
type Bones = {names: string[]; start: Iterable<number>; end: Iterable<number>; joint: Iterable<number>}  // Segments, their joints and names.
type Rings = {joint: number; joints: number; centre: Iterable<number>; below: Iterable<number>}  // The rings that turn a joint.
type Knob = {joint: number; at: Iterable<number>; mirror: Iterable<number> | null}  // The knob that moves a joint.
type Box = {box: Vector[]}  // The box across which a plane is dragged: its lowest and its highest corner.
type Brush = {radius: number; mirror: Iterable<number> | null}  // The brush of the view.
type Through = {through: boolean}  // Whether the lasso selects through the body.
type Motion = {times: Float64Array; matrices: Float32Array}  // A motion: the joints' matrices at some times.
type Wave = {seconds: number; end: number}  // A running wavefront.
type Skin = {joints: Uint16Array; weights: Float32Array; count: number}  // The joints that move each point, and their weights.
type Apart = {joints: Uint16Array; weights: Float32Array; count: number; unit: number}  // The skin of another method, and the length by which distances to it are coloured.
type Painted = {gone?: boolean; vertices?: Uint32Array; colors?: Uint8Array; scalars?: Float32Array; readings?: Float32Array; joints?: Uint16Array; weights?: Float32Array; count?: number}  // What a stroke changed of some vertices; `gone`: there is no stroke any more.
type Paint = {opacity: number; width: number; thick: number; dash: number; ambient: number; diffuse: number; behind: boolean; closed: boolean; hull: boolean; edges: boolean; coloured: boolean; color: Vector; form: string}  // How an actor is drawn.
type Reading = {text: string; values: Float32Array | null; names: string[]; percent: boolean; unit: number}  // What the card says under the pointer.
type Materials = {corners: Float32Array; tints: Uint8Array}  // Texture coordinates of the corners, and colours of the triangles.
type Place = {overlay: boolean; view: number | null}  // Whether an actor is drawn over the others, and in which view; None: in all.
type Part = {kind?: string; points?: Float32Array; normals?: Float32Array; cells?: Uint32Array; skin?: Skin | null; apart?: Apart | null; colors?: Uint8Array; scalars?: Float32Array; table?: Uint8Array; limits?: Vector; materials?: Materials; paint?: Paint; place?: Place; visible?: boolean; animation?: boolean; reading?: Reading | null; repainted?: Painted; clipped?: boolean; slab?: number}  // What changed of an actor.
type Picture = {count: number; picture: ArrayBuffer}  // A picture of the view, as a file, and the number of its request.
type UploadAnswer = {ok?: boolean; message?: string}  // What becomes of an upload.
type Copied = {text: string; what: string}  // A text for the clipboard, and its kind.
type Download = {name: string; content: ArrayBuffer}  // A file to save.
type ToBrowser = {id?: number; page?: string; actors?: Record<string, Part>; remove?: string[]; cut?: Cut | null; front?: number | null; images?: Images | null; legend?: Legend | null; views?: string[]; pose?: Float32Array | null; blending?: 'linear' | 'dual'; lights?: [Vector, number][]; theme?: Theme; dark?: boolean; camera?: Cameras; home?: boolean; bones?: Bones | null; gizmo?: Rings | null; mover?: Knob | null; points?: Record<string, Vector> | null; handles?: Box | null; brush?: Brush | null; lasso?: Through | null; clip?: Motion | null; playing?: boolean; time?: number; animation?: Wave | null; address?: string; link?: string; able?: boolean[]; rendered?: boolean; frame?: Picture; painted?: Painted; idle?: number; upload?: UploadAnswer; copy?: Copied; download?: Download}  // A message to the view, of any of these parts.
type FromBrowser =
  | {type: 'ready'; width?: number; page?: string | null; dark?: string | null; calm?: boolean; pictures?: boolean}  // The view is there; `page` is the key of the page before a reload.
  | {type: 'camera-moved'; position: Vector; focal_point: Vector; aspect?: number | null; height?: number | null; home?: boolean}  // The view rests.
  | {type: 'time'; time: number}  // Time of the motion.
  | {type: 'pick'; joint: number}  // A joint is chosen: in the view, in the tree, or on a card.
  | {type: 'pick-vertex'; vertex: number; view?: number}  // A vertex is chosen: in one of the views side by side, or in a table.
  | {type: 'pick-node'; node: number}  // A node of the graph is chosen: in the view, or on a card.
  | {type: 'pick-strongest'; vertex: number}  // The strongest joint at a vertex is to be chosen.
  | {type: 'turn'; joint: number; axis: number; degrees: number; begin?: boolean}  // A ring is dragged.
  | {type: 'move-joint'; joint: number; position: Vector; done?: boolean}  // A joint is dragged in the scene.
  | {type: 'move-point'; name: string; position: Vector; done?: boolean}  // A point that a feature declares is dragged in the scene.
  | {type: 'move-cut'; origin: Vector; normal: Vector}  // The cutting plane is dragged.
  | {type: 'paint'; points?: number[]; mode?: string | null; first?: boolean; done?: boolean; cancelled?: boolean}  // A piece of a stroke, or its end.
  | {type: 'lasso'; vertices: number[]; mode: string}  // A line was drawn around vertices.
  | {type: 'halt-wave'; front: number}  // The wavefront is halted at a part of the greatest distance.
  | {type: 'play'; on: boolean}  // The motion is played or paused.
  | {type: 'act'; act: string}  // A key is pressed.
  | {type: 'visit'; query: string}  // The browser goes back or forward.
  | {type: 'draw-frame'; count: number; size: [number, number]; ratio: number; fine: boolean; position: Vector; focal_point: Vector; centre: [number, number]; tiles: number[][]}  // A picture of the view is wanted.
  | {type: 'ask-idle'; number: number}  // A test wants to know when no work is left.
  | {type: 'upload-begin'; files: Announced[]}  // Files follow.
  | {type: 'upload-piece'; index: number; data: ArrayBuffer}  // A part of a file.
  | {type: 'upload-end'}  // All files are sent.
  | {type: 'upload-cancel'; unreadable?: boolean}  // The upload ends without its files.
  | {type: 'close'}  // The card of a vertex is closed.
  | {type: 'explain'}  // The explanation of its weights is shown or hidden.
  | {type: 'show-part'}  // Its part of the mesh is shown alone.
  | {type: 'override'; weights: [number, number][] | null}  // Its weights are set, pairs of joint and weight; null: computed.
  | {type: 'carry'; joint: number; on: boolean}  // A joint may deform the mesh or not.
  | {type: 'show-step'; step: number}  // A step of the lesson is shown.
  | {type: 'answer'; value: string | number}  // A person answers the step.
  | {type: 'offer'; index: number}  // A button of the step is pressed.
  | {type: 'choose-value'; name: string; value: any}  // A number in the step's text is changed.
  | {type: 'stage'; on: boolean}  // The lesson is presented or not.
  | {type: 'pick-row'; name: string; nth?: number}  // A row is chosen: the nth of a name, since rows may move meanwhile.
  | {type: 'point-at-row'; name: string | null; nth?: number}  // The pointer comes to a row, the nth of a name; null: it leaves.
  | {type: 'sort'; column: number}  // A heading of the table of weights is clicked: of a joint, or of a column below zero.
  | {type: 'page'; page: number}  // Another page of it is wanted.
  | {type: 'edit-weight'; vertex: number; joint: number; value: number}  // A weight is edited.
  | {type: 'pick-bars'; first: number; last: number}  // Bars of the histogram are chosen.
  | {type: 'pick-point'; id: string}  // A point of a curve is chosen.
  | {type: 'show-method'; id: string; on: boolean}  // A method is shown or not.
