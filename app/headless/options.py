"""Options of `cutcell render` as choices of the page, and their checks."""

import re
from collections.abc import Callable, Mapping
from typing import Any

import param

from cutcell.checks import check_choice, check_number
from cutcell.errors import ParameterError

from ..document.state import State
from ..looks.measures import MAX_MEASURES, MEASURES

LAYERS = {
    "body": "body",
    "mesh": "mesh_edges",
    "interior": "interior_edges",
    "surface": "surface_edges",
    "nodes": "nodes",
}
"""Names of the layers of the graph as options, and in the state."""

LARGEST = 8192
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


def apply(state: State, settings: Mapping[str, Any]) -> None:
    """Set choices of the page; raise a `ParameterError` for those that it does not have."""
    for name, value in settings.items():
        if name not in state.param or name == "name":
            raise ParameterError(f'the page has no choice "{name}"')
        parameter = state.param[name]
        if isinstance(parameter, param.Selector):
            check_choice(name, value, parameter.objects)
        elif isinstance(parameter, param.Number):
            low, high = parameter.bounds or (None, None)
            if low is not None and high is not None:
                check_number(name, value, low, high)
        try:
            setattr(state, name, value)
        except ValueError:
            raise ParameterError(f'{name} cannot be "{value}"') from None
    count = 0 if state.rig is None else len(state.rig.mesh.vertices)
    if state.vertex is not None and not 0 <= state.vertex < count:
        raise ParameterError(f"vertex must be one of 0 to {count - 1}, not {state.vertex}")


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
    form = f"width x height in pixels, 16 to {LARGEST} each, such as 1600x1200"
    sides = _groups("size", text.strip(), r"(\d{1,5})\s*[x×]\s*(\d{1,5})", form)
    width, height = map(int, sides)
    if not 16 <= min(width, height) <= max(width, height) <= LARGEST:
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
    place = {"slicing": True, "slice_axis": axis, **_part("slice", "slice_position", at)}
    return {**place, **({"slice_rays": rays} if rays else {})}


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
