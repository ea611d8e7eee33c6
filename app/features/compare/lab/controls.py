"""Laboratory: sweep an option, look at its curves, choose a setting, save the numbers."""

from collections.abc import Sequence
from functools import partial
from typing import Any

from ....document.session import Session
from ....document.state import State
from ....looks.measures import CONVERGED
from ....widgets import controls as ui
from ....widgets.curves import Curves
from . import results as actions
from .choices import MEASURES, OPTIONS, VALUES
from .curves import plot
from .methods import Methods
from .rows import Setting, is_chosen, number, settings_of

COLUMNS = [
    ("L1", "Weight error: 0 same, 2 nothing in common"),
    ("prec.", "Precision: share of the influences that the reference has, too"),
    ("recall", "Share of the reference's influences that are there"),
    ("mm", "Deformation error, root mean square, the longest side scaled to 1 m"),
    ("s", "Seconds"),
]
FIELDS = ("l1", "precision", "recall", "deformation", "seconds")
DISTANCE_COLUMNS = [
    ("%", f"Mean error of the bone's distances, against any angle at R = {CONVERGED}"),
    ("s", "Seconds"),
]
DISTANCE_FIELDS = ("error", "seconds")
NUMBERS = ("resolution", "winding_threshold", "alpha", "max_influences", "threshold")
"""Options whose values are places on an axis."""


def _of_weights(state: State) -> bool:
    return bool(state.sweep_of == "weights")


def _runs(state: State) -> bool:
    return bool(state.sweeping or state.measuring_errors)


def about(state: State) -> str:
    """Name the reference of the numbers."""
    if not _of_weights(state):
        text = f"The bone's distances against any angle at R = {CONVERGED}."
        return text if not ui.weightless(state) else "This bone has no distances."
    layers = " Layers are left out." if state.edits.layers else ""
    if ui.has_weights(state):
        return f"Errors against the file's weights.{layers}"
    return f"Errors against the default of the option: the file has no weights.{layers}"


def table(state: State) -> dict[str, Any]:
    """Return columns and rows of the table, as `methods.js` takes them."""
    is_weights = _of_weights(state)
    fields = FIELDS if is_weights else DISTANCE_FIELDS
    rows = [_row(state, one, fields) for one in settings_of(state)]
    return {"rows": rows, "columns": COLUMNS if is_weights else DISTANCE_COLUMNS}


def _row(state: State, one: Setting, fields: Sequence[str]) -> dict[str, Any]:
    is_running = ("swept", one.id) in state.computing
    note = one.note or ("Computing" if is_running else "")
    return {
        "id": one.id,
        "title": one.title,
        "values": [number(one.values[name]) if one.values else "" for name in fields],
        "best": [False] * len(fields),
        "note": note[:1].upper() + note[1:],
        "state": "failed" if one.note else "running",
        "chosen": is_chosen(state, one),
        "fixed": bool(one.note),
    }


def _choose(session: Session, id: str) -> None:
    for one in settings_of(session.state):
        if one.id == id:
            actions.choose(session, one.choices)


def _tick(session: Session, row: tuple[str, bool]) -> None:
    _choose(session, row[0])


def plots(state: State) -> list[dict[str, Any]]:
    """Return the plots of what is measured so far."""
    settings = [one for one in settings_of(state) if one.values]
    if not settings:
        return []
    draw = partial(plot, settings, is_chosen=partial(is_chosen, state))
    if not _of_weights(state):
        return [
            draw("error", "Mean error in %", x="resolution", logarithmic=True),
            draw("seconds", "Seconds", x="resolution", logarithmic=True),
        ]
    title = next(title for title, name in MEASURES.items() if name == state.sweep_measure)
    x = state.sweep_option if state.sweep_option in NUMBERS else ""
    return [draw(state.sweep_measure, title, x=x)]


def _is_empty(state: State) -> bool:
    return not any(one.values or one.note for one in settings_of(state))


def _is_complete(state: State) -> bool:
    """Return whether there is nothing to compute."""
    if state.binding is None:
        return True
    if not _of_weights(state):
        return bool(state.error_curves) or ui.weightless(state)
    return all(text in state.swept for text in state.sweep_texts)


SWEEP = ui.folded(
    "Sweep",
    ui.choice("sweep_of"),
    ui.caption(about),
    ui.column(
        ui.select("sweep_option", "Option", act=actions.choose_option, options=OPTIONS),
        ui.text_box(
            "Values",
            act=actions.choose_values,
            value=lambda state: state.sweep_values or VALUES[state.sweep_option],
        ),
        visible=_of_weights,
    ),
    ui.row(
        ui.button("Compute", actions.start, visible=lambda s: not _runs(s), disabled=_is_complete),
        ui.button("Stop computing", actions.stop, visible=_runs),
    ),
    ui.select("sweep_measure", "Curve", visible=_of_weights, margin=(10, 0, 0, 0)),
    ui.Control(Curves, act=_choose, plots=plots, **ui.FULL),
    ui.Control(
        Methods, act=_tick, heading="Setting", single=True, label="Settings",
        shows=table, margin=(2, 0, 6, 0), **ui.WIDE,
    ),
    ui.caption("Click a point, or tick a setting, to show it on the character."),
    ui.button("Save as CSV", actions.export, icon="download", disabled=_is_empty),
    needed=_runs,
)  # fmt: skip
