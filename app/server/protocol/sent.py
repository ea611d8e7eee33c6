"""Messages to the browser: dictionaries, which Panel sends as they are."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, Literal, TypedDict

import numpy as np
from numpy.typing import NDArray

Vector = Sequence[float]
Numbers = Sequence[float] | NDArray[Any]
Floats = NDArray[np.float32]
Bytes = NDArray[np.uint8]


class Camera(TypedDict):
    """Where one looks from, and at what."""

    position: Vector
    focal_point: Vector


class Cameras(Camera, total=False):
    """The initial view, and the view now."""

    now: Camera | None


class Cut(TypedDict):
    """The plane that cuts."""

    origin: Vector
    normal: Vector


class Images(TypedDict):
    """Images of materials."""

    count: int
    side: int
    pixels: Bytes


class Legend(TypedDict):
    """Colours and what they mean."""

    title: str
    low: str
    high: str
    table: Bytes | None
    swatches: list[tuple[str, str]]


class Theme(TypedDict):
    """Colours of the overlay."""

    top: str
    bottom: str
    ink: str
    card: str
    paper: str


class Bones(TypedDict):
    """Segments, their joints and names."""

    names: list[str]
    start: Numbers
    end: Numbers
    joint: Numbers


class Rings(TypedDict):
    """The rings that turn a joint."""

    joint: int
    joints: int
    centre: Numbers
    below: Numbers


class Knob(TypedDict):
    """The knob that moves a joint."""

    joint: int
    at: Numbers
    mirror: Numbers | None


class Box(TypedDict):
    """The box across which a plane is dragged: its lowest and its highest corner."""

    box: list[Vector]


class Brush(TypedDict):
    """The brush of the view."""

    radius: float
    mirror: Numbers | None


class Through(TypedDict):
    """Whether the lasso selects through the body."""

    through: bool


class Motion(TypedDict):
    """A motion: the joints' matrices at some times."""

    times: NDArray[np.float64]
    matrices: Floats


class Wave(TypedDict):
    """A running wavefront."""

    seconds: float
    end: float


class Skin(TypedDict):
    """The joints that move each point, and their weights."""

    joints: NDArray[np.uint16]
    weights: Floats
    count: int


class Apart(Skin):
    """The skin of another method, and the length by which distances to it are coloured."""

    unit: float


class Painted(TypedDict, total=False):
    """What a stroke changed of some vertices; `gone`: there is no stroke any more."""

    gone: bool
    vertices: NDArray[np.uint32]
    colors: Bytes
    scalars: Floats
    readings: Floats
    joints: NDArray[np.uint16]
    weights: Floats
    count: int


class Paint(TypedDict):
    """How an actor is drawn."""

    opacity: float
    width: float
    thick: float
    dash: float
    ambient: float
    diffuse: float
    behind: bool
    closed: bool
    hull: bool
    edges: bool
    coloured: bool
    color: Vector
    form: str


class Reading(TypedDict):
    """What the card says under the pointer."""

    text: str
    values: Floats | None
    names: list[str]
    percent: bool
    unit: float


class Materials(TypedDict):
    """Texture coordinates of the corners, and colours of the triangles."""

    corners: Floats
    tints: Bytes


class Place(TypedDict):
    """Whether an actor is drawn over the others, and in which view; None: in all."""

    overlay: bool
    view: int | None


class Part(TypedDict, total=False):
    """What changed of an actor."""

    kind: str
    points: Floats
    normals: Floats
    cells: NDArray[np.uint32]
    skin: Skin | None
    apart: Apart | None
    colors: Bytes
    scalars: Floats
    table: Bytes
    limits: Vector
    materials: Materials
    paint: Paint
    place: Place
    visible: bool
    animation: bool
    reading: Reading | None
    repainted: Painted
    clipped: bool
    slab: float


class Picture(TypedDict):
    """A picture of the view, as a file, and the number of its request."""

    count: int
    picture: bytes


class UploadAnswer(TypedDict, total=False):
    """What becomes of an upload."""

    ok: bool
    message: str


class Copied(TypedDict):
    """A text for the clipboard, and its kind."""

    text: str
    what: str


class Download(TypedDict):
    """A file to save."""

    name: str
    content: bytes


class ToBrowser(TypedDict, total=False):
    """A message to the view, of any of these parts."""

    id: int
    page: str
    actors: dict[str, Part]
    remove: list[str]
    cut: Cut | None
    front: float | None
    images: Images | None
    legend: Legend | None
    views: list[str]
    pose: Floats | None
    blending: Literal["linear", "dual"]
    lights: list[tuple[Vector, float]]
    theme: Theme
    dark: bool
    camera: Cameras
    home: bool
    bones: Bones | None
    gizmo: Rings | None
    mover: Knob | None
    points: dict[str, Vector] | None
    handles: Box | None
    brush: Brush | None
    lasso: Through | None
    clip: Motion | None
    playing: bool
    time: float
    animation: Wave | None
    address: str
    link: str
    able: list[bool]
    rendered: bool
    frame: Picture
    painted: Painted
    idle: int
    upload: UploadAnswer
    copy: Copied
    download: Download
