"""Methods side by side: which, what of them is seen, and how good they are."""

from typing import Any

import panel_material_ui as pmui

from cutcell.rig import Rig

from ..commands import compare as actions
from ..commands import pose
from ..commands.session import Session
from ..scenes.compare import field_shown, found_of, title_of
from ..state import State
from ..state.compare import FEWEST_VIEWS, MAX_VIEWS, offered
from ..widgets.methods import Methods
from .controls import (
    BESIDE,
    BUTTONS,
    button,
    caption,
    column,
    follow,
    intro,
    play_button,
    rest_button,
    row,
    section,
    select_box,
    when,
)  # fmt: skip

FIELDS = {"Selected bone": "bone", "All bones": "all"}
ERROR = {"Error": "error"}
COLUMNS = [
    ("L1", "Weight error against the original weights: 0 same, 2 nothing in common"),
    ("mm", "Deformation error, root mean square, the longest side scaled to 1 m"),
    ("s", "Seconds"),
]
WATCHED = ["methods", "compared", "comparing", "queued", "binding", "rig"]


def compare(session: Session) -> pmui.Column:
    """Return the controls of the panel Compare."""
    state = session.state
    table = Methods(
        lambda name, chosen: actions.choose(session, name, chosen),
        columns=COLUMNS,
        sizing_mode="stretch_width",
        margin=(2, 0, 6, 0),
    )

    def listed(*events: Any) -> None:
        table.rows = rows_of(state)

    state.param.watch(listed, WATCHED)
    listed()
    stop = button(
        "Stop computing", lambda: actions.cancel(session), visible=when(bool, state.param.comparing)
    )
    play = play_button(state.param.playing, lambda: pose.play(session), margin=BESIDE)
    motion = row(play, rest_button(session))
    controls = (_field(state), _minus(state), table, stop, motion)
    about_errors = caption(when(about, state.param.rig))
    return column(
        intro("Two to four methods side by side, under one camera."),
        section("", about_errors, *controls, margin=(4, 20, 4, 20)),
    )


def about(rig: Rig | None) -> str:
    """Return what the columns of errors tell, and against what."""
    if rig is not None and rig.weights is None:
        return "The file has no weights to compare with."
    return "L1 (weights) and mm (motion): errors against the original weights."


def _field(state: State) -> pmui.RadioButtonGroup:
    def offered() -> tuple[dict[str, str], str]:
        no_weights = state.rig is None or state.rig.weights is not None
        value = state.compare_field if state.rig is None else field_shown(state)
        return {**FIELDS, **(ERROR if no_weights else {})}, value

    row = pmui.RadioButtonGroup(options=FIELDS, value="bone", **BUTTONS)
    return follow(row, state, "compare_field", offered, ["rig"])


def _minus(state: State) -> pmui.Select:
    visible = when(
        lambda *_: state.rig is None or field_shown(state) != "error",
        state.param.compare_field,
        state.param.rig,
    )
    select = select_box("Difference to", {}, margin=(10, 0, 4, 0), visible=visible)

    def offered() -> tuple[dict[str, str], str]:
        named = {title_of(name): name for name in state.methods}
        return {"None": "", **named}, state.minus

    return follow(select, state, "minus", offered, ["methods"])


def rows_of(state: State) -> list[dict[str, Any]]:
    """Return the rows of the table, as `js/methods.js` takes them."""
    names = offered(state.rig)
    results = {name: found_of(state, name) for name in names}
    best = {
        measure: min(
            (getattr(one, measure) for name, one in results.items()
             if one is not None and name != "artist" and getattr(one, measure) is not None),
            default=None,
        )
        for measure in ("l1", "deformation")
    }  # fmt: skip
    rows = []
    for name in names:
        one, chosen = results[name], name in state.methods
        note, kind = _note(state, name, one, chosen)
        values = (None,) * 3 if one is None else (one.l1, one.deformation, one.seconds)
        if name == "artist":
            values = (*values[:2], None)  # nobody knows how long that took
        full = len(state.methods) >= MAX_VIEWS
        rows.append(
            {
                "id": name,
                "title": title_of(name),
                "values": [
                    _number(_rms(value) if k == 1 else value, k) for k, value in enumerate(values)
                ],
                "best": [
                    value is not None and name != "artist" and value == best.get(measure)
                    for measure, value in zip(("l1", "deformation", ""), values, strict=True)
                ],
                "note": note,
                "state": kind,
                "chosen": chosen,
                "fixed": len(state.methods) <= FEWEST_VIEWS if chosen else full,
            }
        )
    return rows


def _note(state: State, name: str, one: Any, chosen: bool) -> tuple[str, str]:
    if one is not None and one.failed:
        return one.failed[:1].upper() + one.failed[1:], "failed"
    if one is not None and one.unweighted:
        return f"{one.unweighted:.1%} without weight", "note"
    if one is None and chosen:
        if state.comparing != name:
            return "Waiting", "note"
        if state.queued:
            return "Waiting for other visitors", "note"
        return "Computing", "running"
    return "", ""


def _rms(deformation: float | None) -> float | None:
    """Return a mean squared error in cm² as a length in mm."""
    return None if deformation is None else 10 * deformation**0.5


def _number(value: float | None, column: int) -> str:
    if value is None:
        return ""
    if column == 0:
        return f"{value:.2f}"
    return f"{value:.0f}" if value >= 99.5 else f"{value:.1f}"
