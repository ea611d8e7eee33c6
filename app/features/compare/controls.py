"""Methods side by side: which, what of them is seen, and how good they are."""

from typing import Any

from ...document.side_by_side import FEWEST_VIEWS, MAX_VIEWS, listed
from ...document.state import State
from ...looks.controls import REST
from ...looks.methods import title_of
from ...looks.pose import play
from ...widgets import controls as ui
from . import results as actions
from .disagreement.controls import DISAGREEMENT
from .lab.choices import VALUES
from .lab.controls import SWEEP
from .lab.methods import Methods
from .scene import field_shown

FIELDS = {"Bone": "bone", "Branch": "branch", "All bones": "all"}
ERROR = {"Error": "error"}
COLUMNS = [
    ("L1", "Weight error against the original weights: 0 same, 2 nothing in common"),
    ("mm", "Deformation error, root mean square, the longest side scaled to 1 m"),
    ("s", "Seconds"),
]


def about(state: State) -> str:
    """Name the reference of the columns of errors."""
    if state.rig is not None and state.rig.weights is None:
        return "The file has no weights to compare with."
    return "L1 (weights) and mm (motion): errors against the original weights."


def _fields(state: State) -> dict[str, Any]:
    """Return the choices of what is seen, and the chosen one."""
    error = ERROR if state.rig is None or state.rig.weights is not None else {}
    field = state.compare_field if state.rig is None else field_shown(state)
    return {"options": {**FIELDS, **error}, "value": field}


def _is_comparing(state: State) -> bool:
    return any(name == "compared" for name, *_ in state.computing)


def rows_of(state: State) -> list[dict[str, Any]]:
    """Return the rows of the table, as `js/methods.js` takes them."""
    names = listed(state.rig, state.methods)
    results = {name: state.compared.get(name) for name in names}
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
        if ("compared", name) not in state.computing:
            return "Waiting", "note"
        if ("compared", name) in state.queued:
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


ADD = ui.column(
    ui.row(
        ui.select("added_option", "Change", margin=ui.BESIDE),
        ui.text_box(
            "To",
            name="added_value",
            margin=ui.GAP,
            placeholder=lambda state: VALUES.get(state.added_option, ""),
            visible=lambda state: bool(state.added_option),
        ),
    ),
    ui.button("Add settings", actions.add, disabled=lambda state: len(state.methods) >= MAX_VIEWS),
)
FIELD = ui.choice("compare_field", shows=_fields)
CONTROLS = ui.column(
    ui.intro("Two to four methods side by side, under one camera."),
    ui.section(
        "",
        ui.caption(about),
        FIELD,
        ui.select(
            "minus",
            "Difference to",
            options=lambda state: {"None": "", **{title_of(name): name for name in state.methods}},
            margin=(10, 0, 4, 0),
            visible=lambda s: s.rig is None or field_shown(s) != "error",
        ),
        top=4,
    ),
    DISAGREEMENT,
    ui.section(
        "",
        ui.Control(
            Methods,
            act=lambda session, row: actions.choose(session, *row),
            columns=COLUMNS,
            shows=lambda state: {"rows": rows_of(state)},
            margin=(2, 0, 6, 0),
            **ui.WIDE,
        ),
        ADD,
        ui.button("Stop computing", actions.cancel, visible=_is_comparing),
        ui.row(ui.play_button(play, margin=ui.BESIDE), REST),
        top=4,
    ),
    SWEEP,
)
