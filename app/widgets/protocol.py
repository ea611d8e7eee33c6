"""The messages between browser and server, each declared once: its meaning, and types of its parts.

`python -m cutcell_app.widgets.protocol` writes them for the scripts, into `messages.d.ts`.
"""

from collections.abc import Iterator

from .modules import FOLDER

FROM_BROWSER = {
    "ready": (
        "The view is there.",
        "width: number; dark: string | null; calm: boolean; pictures: boolean",
    ),
    "camera": (
        "The view rests.",
        "home: boolean; position: Vector; focal_point: Vector; aspect: number; height?: number",
    ),
    "time": ("Time of the motion.", "time: number"),
    "pick": ("A joint is clicked.", "joint: number"),
    "pick-vertex": ("A vertex is clicked in a view.", "vertex: number; view: number"),
    "pick-node": ("A node of the graph is clicked.", "node: number"),
    "turn": ("A ring is dragged.", "joint: number; axis: number; degrees: number; begin: boolean"),
    "joint": ("A joint is dragged.", "joint: number; position: Vector; done: boolean"),
    "cut": ("The plane is dragged.", "origin: Vector; normal: Vector"),
    "brush": (
        "A piece of a stroke, or its end.",
        "points?: number[]; first?: boolean; mode?: string | null; done?: boolean; "
        "cancelled?: boolean",
    ),
    "lasso": ("A line was drawn around vertices.", "vertices: number[]; mode: string"),
    "strongest": ("The strongest bone at a vertex is to be chosen.", "vertex: number"),
    "front": ("The wavefront is halted.", "front: number"),
    "play": ("The motion is played or paused.", "on: boolean"),
    "act": ("A key is pressed.", "act: string"),
    "visit": ("The browser goes back or forward.", "query: string"),
    "frame": (
        "A picture is wanted.",
        "count: number; size: number[]; ratio: number; fine: boolean; position: Vector; "
        "focal_point: Vector; centre: number[]; tiles: number[][]",
    ),
    "idle?": ("A test wants to know when no work is left.", "number: number"),
    "upload-begin": ("Files follow.", "files: {name: string; size: number}[]"),
    "upload-piece": ("A part of a file.", "index: number; data: ArrayBuffer"),
    "upload-end": ("All files are sent.", ""),
    "upload-cancel": ("The upload ends without its files.", "unreadable?: boolean"),
}
"""Meaning and content of each message of the view."""

FROM_WIDGETS = {
    "close": ("The card of a vertex is closed.", ""),
    "explain": ("Its explanation is shown or hidden.", ""),
    "part": ("Its part of the mesh is shown alone.", ""),
    "overrule": ("Its weights are given; null: computed.", "weights: number[][] | null"),
    "node": ("A neighbour of a node is chosen.", "node: number"),
    "bone": ("A bone of the card is chosen.", "joint: number"),
    "choose": ("A joint of the tree is chosen.", "joint: number"),
    "carry": ("A joint may deform the mesh or not.", "joint: number; on: boolean"),
    "step": ("A step of the lesson is shown.", "step: number"),
    "answer": ("A person answers the step.", "value: string | number"),
    "offer": ("A button of the step is pressed.", "index: number"),
    "choose-value": ("A number in the step's text is changed.", "name: string; value: any"),
    "stage": ("The lesson is presented or not.", "on: boolean"),
    "row": ("A row is chosen.", "row: number"),
    "row-point": ("The pointer comes to a row; -1: it leaves.", "row: number"),
    "sort": ("A heading of the table of weights is clicked.", "sort: number"),
    "page": ("Another page of it is wanted.", "page: number"),
    "row-vertex": ("The vertex of a row is clicked.", "vertex: number"),
    "edit": ("A weight is edited.", "vertex: number; column: number; value: number"),
    "bars": ("Bars of the histogram are chosen.", "first: number; last: number"),
    "point": ("A point of a curve is chosen.", "id: string"),
    "method": ("A method is shown or not.", "id: string; on: boolean"),
}
"""The same of the widgets beside the view."""

TO_BROWSER = {
    "id": ("Number of the message.", "number"),
    "actors": ("Parts of actors that changed, by name.", "Record<string, Part>"),
    "remove": ("Names of actors.", "string[]"),
    "cut": ("The plane that cuts.", "Cut | null"),
    "front": ("The wavefront's distance.", "number | null"),
    "images": ("Images of materials.", "Images | null"),
    "legend": ("Colours and what they mean.", "Legend | null"),
    "views": ("Captions of the views.", "string[]"),
    "pose": ("Matrices of the joints.", "Float32Array | null"),
    "blending": ("Matrices or dual quaternions.", "'linear' | 'dual'"),
    "lights": ("Positions and intensities.", "[Vector, number][]"),
    "theme": ("Colours of the overlay.", "Theme"),
    "dark": ("To be remembered.", "boolean"),
    "camera": ("The initial view, and the view now.", "Camera & {now?: Camera | null}"),
    "home": ("Go to the initial view.", "boolean"),
    "bones": ("Segments, their joints and names.", "Bones"),
    "gizmo": ("The rings.", "Rings | null"),
    "mover": ("The joint's knob.", "Knob | null"),
    "handles": ("The plane's knobs.", "{box: Vector[]} | null"),
    "brush": ("The brush.", "Brush | null"),
    "lasso": ("The lasso.", "{through: boolean} | null"),
    "clip": ("A motion.", "Motion | null"),
    "playing": ("Whether it runs.", "boolean"),
    "animation": ("A running wavefront.", "Wave | null"),
    "address": ("The page's address.", "string"),
    "link": ("What to copy: without the step of the lesson on panels of no step.", "string"),
    "able": ("Keys that do something.", "boolean[]"),
    "rendered": ("Whether PyVista draws the view that rests.", "boolean"),
    "frame": ("A picture.", "{count: number; picture: ArrayBuffer}"),
    "painted": ("What a stroke changed.", "Painted"),
    "idle": ("The number of a question: no work is left.", "number"),
    "upload": ("What becomes of an upload.", "{ok: boolean; message?: string}"),
    "copy": ("A text for the clipboard, and its kind.", "{text: string; what: string}"),
    "download": ("A file to save.", "{name: string; content: ArrayBuffer}"),
}
"""Meaning and content of each part of a message to the view."""

SHAPES = {
    "Vector": "number[]",
    "Camera": "{position: Vector; focal_point: Vector}",
    "Cut": "{origin: Vector; normal: Vector}",
    "Images": "{count: number; side: number; pixels?: Uint8Array}",
    "Legend": "Record<'title' | 'low' | 'high', string> & "
    "{table: Uint8Array | null; swatches: [string, string][]}",
    "Theme": "Record<'top' | 'bottom' | 'ink' | 'card' | 'paper', string>",
    "Bones": "{names: string[]} & Record<'start' | 'end' | 'joint', Iterable<number>>",
    "Rings": "{joint: number; joints: number} & Record<'centre' | 'below', Iterable<number>>",
    "Knob": "{joint: number; at: Iterable<number>; mirror: Iterable<number> | null}",
    "Brush": "{radius: number; mirror: Iterable<number> | null}",
    "Motion": "{times: Float32Array; matrices: Float32Array}",
    "Wave": "{seconds: number; end: number}",
    "Skin": "{joints: Uint16Array; weights: Float32Array; count: number}",
    "Painted": "Partial<Skin> & "
    "{gone?: boolean; vertices?: Uint32Array; colors?: Uint8Array; scalars?: Float32Array}",
    "Paint": "Record<'opacity' | 'width' | 'thick' | 'dash' | 'ambient' | 'diffuse', number> & "
    "Record<'behind' | 'closed' | 'hull' | 'edges' | 'coloured', boolean> & "
    "{color: Vector; form: string}",
    "Reading": "{text: string; values: Float32Array | null; names: string[]; percent: boolean; "
    "unit: number}",
    "Part": "Partial<{kind: string; points: Float32Array; normals: Float32Array; "
    "cells: Uint32Array; skin: Skin | null; apart: Skin & {unit: number} | null; "
    "colors: Uint8Array; scalars: Float32Array; table: Uint8Array; limits: number[]; "
    "materials: {corners: Float32Array; tints: Uint8Array}; paint: Paint; "
    "place: {overlay: boolean; view: number | null}; visible: boolean; animation: boolean; "
    "reading: Reading | null; clipped: boolean; slab: number}>",
}
"""Types of parts of messages, in TypeScript."""


def typescript() -> str:
    """Return all of it as declarations of types for the scripts."""
    return "\n".join(_lines()) + "\n"


def _lines() -> Iterator[str]:
    yield "// Written by app/widgets/protocol.py."
    for name, shape in SHAPES.items():
        yield f"type {name} = {shape}"
    for name, messages in (("FromBrowser", FROM_BROWSER), ("FromWidgets", FROM_WIDGETS)):
        yield f"type {name} ="
        for kind, (meaning, parts) in messages.items():
            fields = f"type: '{kind}'; {parts}" if parts else f"type: '{kind}'"
            yield f"  | {{{fields}}}  // {meaning}"
    yield "interface ToBrowser {"
    for name, (meaning, shape) in TO_BROWSER.items():
        yield f"  {name}?: {shape}  // {meaning}"
    yield "}"


DECLARATIONS = FOLDER / "common/messages.d.ts"

if __name__ == "__main__":
    DECLARATIONS.write_text(typescript(), encoding="utf-8")
