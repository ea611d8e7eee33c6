"""Choices as plain values, for the address, undo and reloading."""

import re
from collections.abc import Callable
from typing import Any
from urllib.parse import parse_qsl, quote, urlencode

import param

from cutcell.diagnosis import TITLES
from cutcell_viewers.camera import Camera

from .common import MOMENT
from .document import Repair
from .side_by_side import FEWEST_VIEWS, MAX_VIEWS, SINGLE, listed, settled_of, standard
from .state import State

NOTED = ("joint", "turns", "clip", "methods", *SINGLE, "settled")
"""Choices that only apply to the open character."""

FORMER_PANELS = {"geodesics": "distance", "diagnosis": "check"}
"""Names of panels in older addresses, and their names today."""

MAX_REPAIRS = 20

CAMERA = 6
"""Numbers of a camera: the position of the eye, and its target."""


def simple(state: State) -> dict[str, param.Parameter]:
    """Return the parameters that are plain choices: switches, numbers, one of a few.

    Those of `MOMENT` and of tools are none.
    """
    kinds = (param.Boolean, param.Selector, param.Number)
    allowed = state.param.objects("existing")
    plain = {n: p for n, p in allowed.items() if p.precedence != MOMENT and isinstance(p, kinds)}
    return {name: one for name, one in plain.items() if name not in state.tools}


def snapshot(state: State) -> dict[str, Any]:
    """Return the current choices, also those of `NOTED`."""
    return {name: getattr(state, name) for name in (*simple(state), *NOTED)}


def initial(state: State) -> dict[str, Any]:
    """Return the initial values of the plain choices but the panel."""
    return {name: p.default for name, p in simple(state).items() if name != "panel"}


def defaults(state: State) -> dict[str, Any]:
    """Return the initial choices without panel, bone and clip."""
    methods = standard(state.rig, state.opening.base)
    return {**initial(state), "turns": {}, "methods": methods, **dict.fromkeys(SINGLE, ""),
            "settled": (), "edits": state.first_edits}  # fmt: skip


def to_query(
    state: State, upload_key: str = "", camera: list[float] | None = None, edits: str = ""
) -> str:
    """Return the query of the page's address.

    It contains the key of an uploaded character, the camera if it was moved, and edits as
    `EditsFile.text_of` returns them.
    """
    rig = state.rig
    angles = {j: ",".join(f"{a:g}" for a in t) for j, t in state.turns.items() if any(t)}
    values = {
        "rig": state.demo or (f"~{upload_key}" if upload_key else None),
        "panel": state.panel,
        "bone": None if rig is None or state.bare else rig.skeleton.names[state.joint],
        "vertex": None if rig is None else state.vertex,
        **{
            n: _text(v)
            for n, default in initial(state).items()
            if (v := getattr(state, n)) != default
        },
        "clip": None if state.clip == first_clip(rig) else state.clip,
        "methods": None
        if state.methods == standard(rig, state.opening.base)
        else ",".join(state.methods),
        **{n: getattr(state, n) or None for n in SINGLE},
        "settled": ",".join(state.settled) or None,
        "turns": ";".join(f"{j}:{text}" for j, text in angles.items()) or None,
        "repairs": _repairs_text(state.repair),
        "edits": edits or None,
        "step": state.step + 1 if state.step >= 0 else None,
        "answer": None if state.step not in state.answers else _text(state.answers[state.step]),
        "stage": 1 if state.staged else None,
        "camera": None if camera is None else ",".join(f"{x:.4g}" for x in camera),
    }
    entries = {name: value for name, value in values.items() if value is not None}
    return urlencode(entries, quote_via=quote, safe=",:;~", errors="replace")


def from_query(query: str, state: State) -> tuple[dict[str, Any], dict[str, Any], list[str]]:
    """Read an address.

    Returns values of parameters that need no character, the entries of `READERS` that the address
    has, and the entries that could not be read.
    """
    current = simple(state)
    choices: dict[str, Any] = {}
    arrival: dict[str, Any] = {}
    problems: list[str] = []
    for name, text in parse_qsl(query.lstrip("?"), keep_blank_values=True)[:64]:
        try:
            if name in READERS:
                arrival[name] = READERS[name](text)
            else:
                text_now = FORMER_PANELS.get(text, text) if name == "panel" else text
                choices[name] = _value(current[name], text_now)
        except (ValueError, LookupError):
            problems.append(f"{name}={text}"[:60])
    step, answer = arrival.get("step", 0), arrival.pop("answer", None)
    if not 0 <= step < len(state.lesson):
        problems.append(f"step={arrival.pop('step') + 1}"[:60])
    elif answer is not None and "step" in arrival:
        try:
            arrival["answer"] = state.lesson[step].read_answer(answer)
        except ValueError:
            problems.append(f"answer={answer}"[:60])
    return choices, arrival, problems


def with_scene(query: str, state: State) -> str:
    """Return an address with the scene of the step that it names, unless it describes its own.

    Addresses that the page made contain the bone, and all that a person changed since.
    """
    _, arrival, _ = from_query(query, state)
    if "step" not in arrival or "bone" in arrival:
        return query
    scene = state.lesson[arrival["step"]].scene("answer" in arrival)
    return f"{scene}&{query.lstrip('?')}"


def first_clip(rig: Any) -> int:
    """Return the motion that is chosen at first: the first of the file, else a swing."""
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


def _switch(text: str) -> bool:
    if text not in ("", "0", "1"):
        raise ValueError(text)
    return text != "0"


def _repairs_text(repair: Repair | None) -> str | None:
    return None if repair is None else ";".join(map(",".join, repair.codes)) or None


def _repairs(text: str) -> tuple[tuple[str, ...], ...]:
    codes = tuple(tuple(one.split(",")) for one in text.split(";"))
    if len(codes) > MAX_REPAIRS or not {code for one in codes for code in one} <= TITLES.keys():
        raise ValueError(text)
    return codes


def _turns(text: str) -> dict[int, tuple[float, ...]]:
    turns = {}
    for part in filter(None, text.split(";")):
        match = re.fullmatch(r"(\d{1,5}):([-+.\de,]+)", part)
        if not match:
            raise ValueError(part)
        turns[int(match.group(1))] = tuple(numbers_of(match.group(2), 3))
    return turns


def _methods(text: str, fewest: int = FEWEST_VIEWS, most: int = MAX_VIEWS) -> list[str]:
    names = list(dict.fromkeys(text.split(",")))
    if not fewest <= len(names) <= most or not {*names} <= {*listed(None, names), "artist"}:
        raise ValueError(text)
    return names


def numbers_of(text: str, count: int = CAMERA) -> list[float]:
    """Return some numbers that are separated by commas; raise a ValueError for other texts."""
    values = [float(part) for part in text.split(",")]
    if len(values) != count or not all(abs(value) < 1e6 for value in values):
        raise ValueError(text)
    return values


def camera_of(numbers: list[float]) -> Camera:
    """Return the camera of an address: the position of the eye, and its target."""
    return Camera(tuple(numbers[:3]), tuple(numbers[3:]))  # type: ignore[arg-type]


READERS: dict[str, Callable[[str], Any]] = {
    "rig": str, "bone": str, "edits": str, "repairs": _repairs, "turns": _turns,
    "vertex": int, "clip": int,
    "methods": _methods, **dict.fromkeys(SINGLE, lambda text: _methods(text, 1, 1)[0]),
    "camera": numbers_of, "settled": settled_of,
    "step": lambda text: int(text) - 1, "answer": str, "stage": _switch, "playing": _switch,
}  # fmt: skip
"""Readers of the entries that need a character, or are no parameters of the state."""
