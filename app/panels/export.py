"""Export: the character with its new weights, pictures, films, numbers."""

from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np
import panel_material_ui as pmui
from numpy.typing import NDArray

from cutcell.editing.binding_warnings import SAME
from cutcell.editing.corrections import Corrections
from cutcell.io import keeps_document
from cutcell.io.materials.transfer import has_materials
from cutcell.rig import Rig
from cutcell.runtime.display import count

from ..commands import correct
from ..commands import export as actions
from ..commands.session import Session
from ..standalone.page import VIEWS, interactive_page
from ..state import State
from .controls import (
    BESIDE,
    BUTTONS,
    as_text,
    button,
    caption,
    folded,
    has_weights,
    menu,
    row,
    when,
)

WHOSE = {"My weights": True, "Recomputed": False}
"""The file's weights, with what was repaired and painted, or computed ones."""


def export(session: Session) -> pmui.Column:
    """Return the section of the downloads."""
    state, offer = session.state, session.view.offer
    bound = button(
        "Export GLB",
        lambda: actions.export_bound(session, offer),
        icon="download",
        disabled=when(lambda value: value is None, state.param.binding),
        variant="contained",
    )
    films: dict[str, Callable[[], None]] = {
        "Interactive page (HTML)": lambda: actions.export_interactive(session, page(state), offer),
        "Picture (PNG)": lambda: actions.export_picture(session, offer),
        "Turntable (MP4)": lambda: actions.export_turntable(session, "mp4", offer),
        "Turntable (GIF)": lambda: actions.export_turntable(session, "gif", offer),
        "Motion (MP4)": lambda: actions.export_motion(session, "mp4", offer),
        "Motion (GIF)": lambda: actions.export_motion(session, "gif", offer),
        "Sweep (MP4)": lambda: actions.export_sweep(session, "mp4", offer),
        "Sweep (GIF)": lambda: actions.export_sweep(session, "gif", offer),
    }
    numbers: dict[str, Callable[[], None]] = {
        "Weights (CSV)": lambda: actions.export_numbers(session, "weights", "csv", offer),
        "Distances (CSV)": lambda: actions.export_numbers(session, "distances", "csv", offer),
        "Both, with names (NPZ)": lambda: actions.export_numbers(session, "all", "npz", offer),
        "Nodes and edges of the graph (CSV)": lambda: actions.export_graph(session, "zip", offer),
        "Nodes and edges of the graph (NPZ)": lambda: actions.export_graph(session, "npz", offer),
    }
    whose, changed = _whose(session)
    empty = when(lambda rig: rig is None, state.param.rig)
    return folded(
        "Export",
        whose,
        changed,
        bound,
        row(
            menu("Image, video", "movie", films, margin=BESIDE, disabled=empty),
            menu("Data", "table_chart", numbers, disabled=empty),
        ),
        caption(when(_described, state.param.rig, state.param.corrections, state.param.repair)),
    )


def _whose(session: Session) -> tuple[pmui.RadioButtonGroup, pmui.Typography]:
    """Return the choice of the weights that are shown and exported, and what is changed in them."""
    state = session.state
    whose = pmui.RadioButtonGroup(options=WHOSE, **BUTTONS)
    changed = caption()

    def show(*events: Any) -> None:
        ready = has_weights(state.rig) and not state.bare
        whose.param.update(
            value=correct.uses_file(session), visible=ready, disabled=state.graph is None
        )

    def describe() -> None:
        changed.object = as_text(changes_of(state))

    def chosen(event: Any) -> None:
        if event.new != correct.uses_file(session):
            correct.choose_file(session, event.new)

    state.param.watch(show, ["rig", "binding", "corrections"])
    # The colours go first.
    state.param.watch(
        lambda *events: session.tasks.after_a_pause(describe, "changed"),
        ["rig", "binding", "repair"],
    )
    whose.param.watch(chosen, "value")
    show()
    describe()
    return whose, changed


def changes_of(state: State) -> str:
    """Return what of the weights that are exported differs from the file, in a line."""
    rig, binding = state.rig, state.binding
    if binding is None:
        return ""
    file_weights = rig.weights if state.repair is None else state.repair.before.weights
    if file_weights is None or file_weights.shape != binding.weights.shape:
        return "Computed weights."
    differs = _rows_differ(binding.weights, file_weights)
    if not differs.any():
        return "The file's weights, unchanged."
    painted = np.zeros(len(differs), bool)
    painted[list(state.corrections.vertices)] = True
    repaired = ~painted & _rows_differ(binding.weights, file_weights)
    repaired = ~painted & ~_rows_differ(binding.weights, rig.weights)
    kinds = {
        "repaired": differs & repaired,
        "painted": differs & painted,
        "recomputed": differs & ~painted & ~repaired,
    }
    total = count(int(differs.sum()), "vertex")
    counts = {kind: int(rows.sum()) for kind, rows in kinds.items() if rows.any()}
    if len(counts) == 1:
        return f"{total} {next(iter(counts))}."
    return f"{total}: {', '.join(f'{number:,} {kind}' for kind, number in counts.items())}."


def _rows_differ(one: NDArray, other: NDArray) -> NDArray[np.bool_]:
    """Return the vertices with other weights; one, other (n, j)."""
    differs: NDArray[np.bool_] = np.abs(one - other).max(axis=1, initial=0) > SAME
    return differs


def page(state: State) -> Callable[..., str]:
    """Return what makes the interactive page of a state, which begins with what is seen."""
    view = state.panel if state.panel in VIEWS else "weights"
    return partial(interactive_page, view=view)


def _described(rig: Rig | None, corrections: Corrections, repair: object) -> str:
    """Return what the exported file contains."""
    if rig is None or keeps_document(rig):
        moved = any(one.position is not None for one in corrections.joints.values())
        changed = ["weights"]
        changed += ["skeleton"] if moved or corrections.structural else []
        changed += ["mesh"] if repair is not None else []
        summary = f"Only {' and '.join(changed)} of the GLB change."
    elif has_materials(rig):
        summary = "A new GLB: mesh, skeleton, weights, clips and base colours."
    else:
        summary = "A new GLB: mesh, skeleton, weights and clips, no materials."
    return f"{summary} Images show the current view."
