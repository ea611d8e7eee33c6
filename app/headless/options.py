"""The options of `cutcell render`: section, flags, placeholder, help, and the choices they make.

Nothing is imported here that makes `--help` slow.
"""

import re
from collections.abc import Callable
from typing import Any

from cutcell.checks import check_choice, check_number
from cutcell.errors import ParameterError

WHAT = "Content"
INSIDE = "Inside: graph, distance"
HOW = "View"

KINDS: dict[str, Any] = {
    "": bool, "PART": float, "SECONDS": float, "VERTEX": int, "URL": list[str], "TEXT": list[str],
}  # fmt: skip
"""Types of options by their placeholders; all others are texts."""


def _rows(**options: tuple[str, str, str, str]) -> dict[str, tuple[Any, ...]]:
    """Return a table for `with_options`; an option without a value is a switch."""
    rows: dict[str, tuple[Any, ...]] = {}
    for name, (section, flags, placeholder, text) in options.items():
        kind = KINDS.get(placeholder, str)
        default = "/--no-" in flags if kind is bool else None
        rows[name] = (kind if kind is bool else kind | None, default, flags, placeholder, text,
                      section)  # fmt: skip
    return rows


# fmt: off
CHOICES = _rows(
    panel=(WHAT, "--panel -p", "PANEL",
        "As on the page: graph, distance, weights, pose, compare or check. Default: weights."),
    bone=(WHAT, "--bone -b", "NAME",
        "Whose weights or distance. Weights of all bones are mixed if left out."),
    shown=(WHAT, "--show", "WHAT",
        "Of the weights: bone, mix, dominant, count, or difference to the file's own."),
    turn=(WHAT, "--turn", "AXIS=DEGREES",
        "Turn the bone, such as z=30, on the panels pose and compare."),
    error=(WHAT, "--error", "",
        "Colour by the error against the file's own weights: pose, compare."),
    methods=(WHAT, "--methods", "A,B,...",
        "Methods side by side on the panel compare; now is what is set here."),
    finding=(WHAT, "--finding", "CODE",
        "The finding of cutcell diagnose to mark on the panel check."),
    clip=(HOW, "--clip", "NAME", "Film one of the file's motions, by name or number."),
    time=(HOW, "--time", "SECONDS", "With --clip: a picture of that moment instead of a film."),
    sweep=(HOW, "--sweep", "WHAT",
        "Film the wave as it runs from the bone to the farthest vertex, or the cut from one end of"
        " the body to the other: wave, cut."),
    dark=(HOW, "--dark", "", "On a dark ground."),
    skeleton=(HOW, "--bones/--no-bones", "", "Draw the skeleton, too."),
)
"""Fields of `Choices`."""

SETTINGS = _rows(
    blending=(WHAT, "--blending", "HOW",
        "How the joints' transforms are blended on the panels pose and compare: linear, or dual"
        " (dual quaternions)."),
    colors=(WHAT, "--colors", "WHAT",
        "Colours of the body on the panel pose: weights, plain, or materials (the file's)."),
    cut=(INSIDE, "--cut", "PLANE",
        "Cut the body across x, y or z, or by a plane that looks in a direction: degrees around"
        " the upright axis, and up. =0.4 sets the position: z=0.4, 30,20=0.5."),
    face=(INSIDE, "--face", "WHAT",
        "On the face of the cut: distance, winding (its number), or open (graph only)."),
    keep=(INSIDE, "--keep", "WHAT",
        "Behind the cut of a graph: half, face (of the interior), or slab=0.1."),
    layers=(INSIDE, "--layers", "A,B,...", "Of the graph: body, mesh, interior, surface, nodes."),
    color_by=(INSIDE, "--color-by", "WHAT",
        "Colour edges and nodes by kind, depth, distance or component."),
    slice=(INSIDE, "--slice", "AXIS",
        "One slice of the lattice with its rays, such as z, or z=0.5:x, whose rays run along x:"
        " graph."),
    sources=(INSIDE, "--sources", "", "Sources of the distances."),
    colormap=(HOW, "--colormap", "NAME",
        "Colours of distances, depths and a bone's weights: viridis, cividis, plasma, inferno,"
        " magma, turbo or gray, as Matplotlib has them."),
    path=(INSIDE, "--path", "VERTEX", "The shortest path from a vertex to the bone."),
    wave=(INSIDE, "--wave", "PART",
        "Only distances up to this part of the greatest, from 0 to 1."),
    measures=(INSIDE, "--measures", "A,B",
        "The distance by two to four measures side by side, on the panel distance: straight,"
        " surface, voxel, 6, 26, any, converged. R is that of --resolution."),
)
"""Options that `read_settings` turns into choices of the page."""

PICTURE = _rows(
    turntable=(HOW, "--turntable", "", "Film it from all around."),
    view=(HOW, "--view", "VIEW",
        "From where: front, three-quarter, left, right, back or top. If left out: the side that a"
        " finding is on, else three-quarter."),
    near=(HOW, "--near", "PART",
        "A view of the bone, of this part of the longest side, from 0.01 to 1."),
    size=(HOW, "--size", "WxH",
        "In pixels; 1600x1200 for pictures, 960x720 for films if left out."),
    camera=(HOW, "--camera", "X,Y,Z,X,Y,Z",
        "Position of the camera and its target, as in the address of a page."),
    background=(HOW, "--background", "COLOUR",
        "Background of one colour, such as white or #f4f4f4."),
    transparent=(HOW, "--transparent", "", "No background: PNG."),
    legend=(HOW, "--legend/--no-legend", "", "Write the legend on it."),
)
"""Fields of `Picture`."""

FIGURE = _rows(
    address=(WHAT, "--address", "URL",
        "Draw what a page of this address shows, from its camera. Other options come first. The"
        " page's character is not opened. Given several times: the panels of a figure, from one"
        " camera."),
    caption=(WHAT, "--caption", "TEXT", "Caption of a figure's panel; given once for each."),
)
"""Options that may be given several times."""
# fmt: on

LAYERS = {
    "body": "body",
    "mesh": "mesh_edges",
    "interior": "interior_edges",
    "surface": "surface_edges",
    "nodes": "nodes",
}
"""Names of the layers of the graph as options, and in the state."""

MAX_SIDE = 8192
"""Largest side of a picture in pixels."""
NUMBER = r"[-+]?(?:\d+\.?\d*|\.\d+)"
FACES = {"open": "open", "distance": "field", "winding": "winding"}


def read_settings(**options: Any) -> dict[str, Any]:
    """Return the choices of the page for options, by their names in `READERS`."""
    choices: dict[str, Any] = {}
    for name, value in options.items():
        if value is not None and value is not False:
            choices |= READERS[name](value)
    return choices


def read_choices(**options: Any) -> dict[str, Any]:
    """Return the fields of `Choices` for options that are set."""
    choices = {name: value for name, value in options.items() if value is not None}
    if "turn" in choices:
        pattern = rf"\s*([xyz])\s*=\s*({NUMBER})\s*°?\s*"
        form = "an axis and degrees, such as z=30"
        axis, degrees = _groups("turn", choices["turn"], pattern, form)
        choices["turn"] = axis, float(degrees)
    if "methods" in choices:
        choices["methods"] = _listed(choices["methods"])
    return choices


def read_size(text: str | None) -> tuple[int, int] | None:
    """Return a width and a height; None without a text."""
    if not text:
        return None
    form = f"width x height in pixels, 16 to {MAX_SIDE} each, such as 1600x1200"
    sides = _groups("size", text.strip(), r"(\d{1,5})\s*[x×]\s*(\d{1,5})", form)
    width, height = map(int, sides)
    if not 16 <= min(width, height) <= max(width, height) <= MAX_SIDE:
        raise ParameterError(f'size must be {form}, not "{text}"')
    return width, height


def _listed(text: str) -> list[str]:
    return [name.strip() for name in text.split(",") if name.strip()]


def _groups(name: str, text: str, pattern: str, form: str) -> tuple[str, ...]:
    """Return the parts of an option's text, or raise an error that shows its form."""
    match = re.fullmatch(pattern, text.lower())
    if match is None:
        raise ParameterError(f'{name} must be {form}, not "{text}"')
    return match.groups()


def _layers(text: str) -> dict[str, Any]:
    names = [check_choice("layer", name, LAYERS) for name in _listed(text)]
    return {choice: name in names for name, choice in LAYERS.items()}


def _face(text: str) -> dict[str, Any]:
    face = FACES[check_choice("face", text, FACES)]
    return {"graph_face": face, **({} if face == "open" else {"cut_face": face})}


def _measures(text: str) -> dict[str, Any]:
    from ..looks.measures import MAX_MEASURES, MEASURES

    names = [check_choice("measure", name, MEASURES) for name in _listed(text)]
    if len(set(names)) > MAX_MEASURES:
        raise ParameterError(f"at most {MAX_MEASURES} measures stand side by side")
    return {f"beside_{name}": True for name in names}


def _cut(text: str) -> dict[str, Any]:
    across, _, at = text.partition("=")
    axis, yaw, pitch = _groups(
        "cut", across, rf"([xyz])|({NUMBER}),({NUMBER})",
        "x, y or z, or two angles in degrees (around the upright axis, and up), and may have a"
        " position, such as z=0.4 or 30,20=0.5",
    )  # fmt: skip
    plane = {"cut_axis": axis or "free"}
    angles = {} if axis else {"cut_yaw": float(yaw), "cut_pitch": float(pitch)}
    return {**plane, **angles, **_part("cut", "cut_position", at)}


def _keep(text: str) -> dict[str, Any]:
    behind, _, thickness = text.partition("=")
    return {"cut_keeps": behind, **_part("keep", "slab", thickness)}


def _slice(text: str) -> dict[str, Any]:
    axis, at, rays = _groups(
        "slice", text, r"([xyz])(?:=([\d.]+))?(?::([xyz]))?",
        "an axis, and may have a position and the axis of its rays, such as z, z=0.5 or z=0.5:x",
    )  # fmt: skip
    choices = {"slicing": True, "slice_axis": axis, **_part("slice", "slice_position", at)}
    return {**choices, **({"slice_rays": rays} if rays else {})}


def _part(name: str, choice: str, text: str | None) -> dict[str, Any]:
    """Return a choice from 0 to 1, the part of an option after its "="; none if there is none."""
    if not text:
        return {}
    try:
        return {choice: check_number(name, float(text), 0, 1)}
    except ValueError:  # no number, or not in the range
        raise ParameterError(
            f'{name} must have a number from 0 to 1 after the =, not "{text}"'
        ) from None


READERS: dict[str, Callable[[Any], dict[str, Any]]] = {
    "blending": lambda text: {"blending": text},
    "colors": lambda text: {"pose_colors": text},
    "colormap": lambda name: {"colormap": name},
    "cut": _cut,
    "face": _face,
    "keep": _keep,
    "layers": _layers,
    "color_by": lambda text: {"edge_colors": text},
    "slice": _slice,
    "sources": lambda on: {"starts": True},
    "path": lambda vertex: {"vertex": vertex, "path": True},
    "wave": lambda part: {"wave": True, "front": part},
    "measures": _measures,
}
"""Functions that turn each option into choices of the page."""
