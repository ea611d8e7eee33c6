"""Choices as plain values, for the address, undo and reloading."""

import re
from typing import Any
from urllib.parse import parse_qsl, quote, urlencode

import param

from cutcell.editing.corrections import Corrections

from . import State
from .brush import BRUSH
from .compare import FEWEST_VIEWS, MAX_VIEWS, offered, standard
from .tour import TOUR

OWN = frozenset({"name", "demo", "queued", "joint", "dark", "moving", "playing", "clip", "skipped",
                 "busy", "stage", "fraction", "message", "tour", "vertex", "node", "part",
                 "animating", "joint_handle", "measuring_errors"}) | BRUSH  # fmt: skip
"""Parameters that belong to one person or moment, or have another word in the address."""

NOTED = ("joint", "turns", "clip", "methods", "minus", "corrections")
"""Choices that only apply to the open character."""

FORMER_PANELS = {"geodesics": "distance", "diagnosis": "check"}
"""Names of panels in older addresses, and their names today."""

CAMERA = 6
"""Numbers of a camera: where the eye is, and what it looks at."""


def simple(state: State) -> dict[str, param.Parameter]:
    """Return the parameters that hold a plain choice: a switch, a number, one of a few."""
    kinds = (param.Boolean, param.Selector, param.Number)
    allowed = state.param.objects("existing")
    return {n: p for n, p in allowed.items() if n not in OWN and isinstance(p, kinds)}


def snapshot(state: State) -> dict[str, Any]:
    """Return all choices as they are, with those that are `NOTED`."""
    return {name: getattr(state, name) for name in (*simple(state), *NOTED)}


def defaults(state: State) -> dict[str, Any]:
    """Return the initial choices without panel, bone and clip."""
    plain = {name: p.default for name, p in simple(state).items() if name != "panel"}
    return {**plain, "turns": {}, "methods": standard(state.rig), "minus": "",
            "corrections": Corrections()}  # fmt: skip


def to_query(
    state: State, upload_key: str = "", camera: list[float] | None = None, corrections: str = ""
) -> str:
    """Return what the address says behind its question mark.

    Parameters
    ----------
    state : State
    upload_key : str
        Key of the uploaded character, if one is open.
    camera : list of 6 float, optional
        Where the eye is and what it looks at; left out where it is as at the start.
    corrections : str
        As `CorrectionsFile.text_of` returns them.
    """
    values: dict[str, str] = {}
    if state.demo or upload_key:
        values["rig"] = state.demo or f"~{upload_key}"
    values["panel"] = state.panel
    if state.rig is not None:
        if not state.bare:
            values["bone"] = state.rig.skeleton.names[state.joint]
        if state.vertex is not None:
            values["vertex"] = str(state.vertex)
    for name, parameter in simple(state).items():
        value = getattr(state, name)
        if name != "panel" and value != parameter.default:
            values[name] = _text(value)
    if state.clip != first_clip(state.rig):
        values["clip"] = str(state.clip)
    if state.methods != standard(state.rig):
        values["methods"] = ",".join(state.methods)
    if state.minus:
        values["minus"] = state.minus
    turned = {j: t for j, t in state.turns.items() if any(t)}
    if turned:
        values["turns"] = ";".join(
            f"{j}:{','.join(f'{a:g}' for a in t)}" for j, t in turned.items()
        )
    if corrections:
        values["corrections"] = corrections
    if state.tour >= 0:
        values["step"] = str(state.tour + 1)
    if camera is not None:
        values["camera"] = ",".join(f"{x:.4g}" for x in camera)
    return urlencode(values, quote_via=quote, safe=",:;~", errors="replace")


def from_query(query: str, state: State) -> tuple[dict[str, Any], dict[str, Any], list[str]]:
    """Read an address.

    Returns
    -------
    choices : dict
        Values for the state's parameters that need no character.
    arrival : dict
        "rig", "bone", "vertex", "turns", "clip", "methods", "minus", "corrections" (as they are
        said), "tour" and "camera", as far as they are said.
    problems : list of str
        What could not be read, each as the address says it.
    """
    current = simple(state)
    choices: dict[str, Any] = {}
    arrival: dict[str, Any] = {}
    problems: list[str] = []
    for name, text in parse_qsl(query.lstrip("?"), keep_blank_values=True)[:64]:
        try:
            if name in ("rig", "bone", "corrections"):
                arrival[name] = text
            elif name == "turns":
                arrival[name] = _turns(text)
            elif name == "step":
                arrival["tour"] = range(len(TOUR))[_positive(text) - 1]
            elif name in ("vertex", "clip"):
                arrival[name] = int(text)
            elif name == "methods":
                arrival[name] = _methods(text, FEWEST_VIEWS)
            elif name == "minus":
                (arrival[name],) = _methods(text, 1)
            elif name == "camera":
                arrival[name] = _numbers(text, CAMERA)
            elif name == "panel":
                choices[name] = _value(current[name], FORMER_PANELS.get(text, text))
            elif name in current:
                choices[name] = _value(current[name], text)
            else:
                raise ValueError(name)
        except (ValueError, IndexError):
            problems.append(f"{name}={text}"[:60])
    return choices, arrival, problems


def first_clip(rig: Any) -> int:
    """Return the motion that is chosen at first: the file's first, else a swing."""
    return 0 if rig is not None and rig.clips else -1


def _text(value: Any) -> str:
    if isinstance(value, bool):
        return "1" if value else "0"
    return f"{value:.6g}" if isinstance(value, float) else str(value)


def _value(parameter: param.Parameter, text: str) -> Any:
    if isinstance(parameter, param.Boolean):
        if text not in ("0", "1"):
            raise ValueError(text)
        return text == "1"
    if isinstance(parameter, param.Selector):
        for one in parameter.objects:
            if str(one) == text:
                return one
        raise ValueError(text)
    value = int(text) if isinstance(parameter, param.Integer) else float(text)
    if parameter.bounds is not None:
        low, high = parameter.bounds
        if (low is not None and value < low) or (high is not None and value > high):
            raise ValueError(text)
    if not abs(value) < 1e9:
        raise ValueError(text)
    return value


def _positive(text: str) -> int:
    if int(text) < 1:
        raise ValueError(text)
    return int(text)


def _turns(text: str) -> dict[int, tuple[float, ...]]:
    turns = {}
    for part in filter(None, text.split(";")):
        match = re.fullmatch(r"(\d{1,5}):([-+.\de,]+)", part)
        if not match:
            raise ValueError(part)
        turns[int(match.group(1))] = tuple(_numbers(match.group(2), 3))
    return turns


def _methods(text: str, fewest: int) -> list[str]:
    names = list(dict.fromkeys(text.split(",")))
    if not fewest <= len(names) <= MAX_VIEWS or not {*names} <= {*offered(None), "artist"}:
        raise ValueError(text)
    return names


def _numbers(text: str, count: int) -> list[float]:
    values = [float(part) for part in text.split(",")]
    if len(values) != count or not all(abs(value) < 1e6 for value in values):
        raise ValueError(text)
    return values
