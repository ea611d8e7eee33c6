"""Options of `cutcell render` for the inside, as choices of the page."""

import re
from collections.abc import Callable, Mapping
from typing import Any

import param

from cutcell.errors import ParameterError
from cutcell.rig.checks import check_choice

from ..state import State
from ..state.distance import MAX_MEASURES, MEASURES

LAYERS = {
    "body": "body",
    "mesh": "mesh_edges",
    "interior": "interior_edges",
    "surface": "surface_edges",
    "nodes": "nodes",
}
"""Names of the layers of the graph as options, and in the state."""

FACES = {"open": "open", "distance": "field", "winding": "winding"}
AXES = ("x", "y", "z")


def settings_of(**options: Any) -> dict[str, Any]:
    """Return the choices of the page for options, by their names in `READERS`.

    Raises
    ------
    ParameterError
        One of them cannot be read; the sentence shows how it is written.
    """
    choices: dict[str, Any] = {}
    for name, value in options.items():
        if value is not None and value is not False:
            choices |= READERS[name](value)
    return choices


def apply(state: State, settings: Mapping[str, Any]) -> None:
    """Set choices of the page.

    Raises
    ------
    ParameterError
        There is no such choice, or it cannot have that value.
    """
    for name, value in settings.items():
        if name not in state.param or name == "name":
            raise ParameterError(f'the page has no choice "{name}"')
        try:
            setattr(state, name, value)
        except ValueError:
            raise ParameterError(_refusal(name, value, state.param[name])) from None
    count = 0 if state.rig is None else len(state.rig.mesh.vertices)
    if state.vertex is not None and not 0 <= state.vertex < count:
        raise ParameterError(f"vertex must be one of 0 to {count - 1}, not {state.vertex}")


def _refusal(name: str, value: Any, parameter: Any) -> str:
    if isinstance(parameter, param.Selector):
        allowed = ", ".join(str(one) for one in parameter.objects)
        return f'{name} must be one of {allowed}, not "{value}"'
    if isinstance(parameter, param.Number) and parameter.bounds is not None:
        low, high = parameter.bounds
        return f"{name} must be a number from {low} to {high}, not {value}"
    return f'{name} cannot be "{value}"'


def _names(text: str) -> list[str]:
    return [name.strip() for name in text.split(",") if name.strip()]


def _layers(text: str) -> dict[str, Any]:
    names = [check_choice("layer", name, LAYERS) for name in _names(text)]
    return {choice: name in names for name, choice in LAYERS.items()}


def _face(text: str) -> dict[str, Any]:
    face = FACES[check_choice("face", text, FACES)]
    return {"graph_face": face, **({} if face == "open" else {"cut_face": face})}


def _measures(text: str) -> dict[str, Any]:
    names = [check_choice("measure", name, MEASURES) for name in _names(text)]
    if len(set(names)) > MAX_MEASURES:
        raise ParameterError(f"at most {MAX_MEASURES} measures stand side by side")
    return {f"beside_{name}": True for name in names}


def _cut(text: str) -> dict[str, Any]:
    across, _, at = text.partition("=")
    choices: dict[str, Any] = {"cut_position": _part("cut", at, text)} if at else {}
    if across.lower() in AXES:
        return {"cut_axis": across.lower(), **choices}
    angles = re.fullmatch(r"([-+]?[\d.]+),([-+]?[\d.]+)", across)
    if not angles:
        raise ParameterError(
            "cut must be x, y or z, or two angles in degrees (around the upright axis, and up), "
            f'and may tell where, such as z=0.4 or 30,20=0.5, not "{text}"'
        )
    yaw, pitch = float(angles[1]), float(angles[2])
    return {"cut_axis": "free", "cut_yaw": yaw, "cut_pitch": pitch, **choices}


def _keep(text: str) -> dict[str, Any]:
    what, _, thick = text.partition("=")
    return {"cut_keeps": what, **({"slab": _part("keep", thick, text)} if thick else {})}


def _slice(text: str) -> dict[str, Any]:
    match = re.fullmatch(r"([xyz])(?:=([\d.]+))?(?::([xyz]))?", text.lower())
    if not match:
        raise ParameterError(
            "slice must be an axis, and may tell where and along which axis its rays run, such as "
            f'z, z=0.5 or z=0.5:x, not "{text}"'
        )
    choices: dict[str, Any] = {"slicing": True, "slice_axis": match[1]}
    if match[2]:
        choices["slice_position"] = _part("slice", match[2], text)
    return {**choices, **({"slice_rays": match[3]} if match[3] else {})}


def _part(name: str, text: str, whole: str) -> float:
    try:
        value = float(text)
    except ValueError:
        value = -1.0
    if not 0 <= value <= 1:
        raise ParameterError(f'{name} must tell a number from 0 to 1 after the =, not "{whole}"')
    return value


READERS: dict[str, Callable[[Any], dict[str, Any]]] = {
    "colors": lambda text: {"pose_colors": text},
    "cut": _cut,
    "face": _face,
    "keep": _keep,
    "layers": _layers,
    "color_by": lambda text: {"edge_colors": text},
    "slice": _slice,
    "sources": lambda shown: {"starts": True},
    "path": lambda vertex: {"vertex": vertex, "path": True},
    "wave": lambda part: {"wave": True, "front": part},
    "measures": _measures,
}
"""Functions that turn each option into choices of the page."""
