"""Export: the character with its new weights, pictures, films, numbers."""

from collections import Counter
from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array

from cutcell.binding.warnings import SAME_WEIGHT
from cutcell.io import keeps_document
from cutcell.io.materials.transfer import has_materials
from cutcell.runtime.display import count

from ..document.document import applied
from ..document.session import Session
from ..document.state import State
from ..editing.compute.stack import vertices_of
from ..editing.correct import commands as correct
from ..headless.interactive import VIEWS, interactive_page
from ..looks.weights import file_rows
from ..widgets import controls as ui
from .export_code import copy_command, copy_script
from .session import export as actions

COMPUTED = "Computed"
WHOSE = {"From file": True, COMPUTED: False}
"""The base below all layers."""
LATE = ("rig", "binding", "repair", "edits")


def changes_of(state: State) -> str:
    """Summarise in a line how the exported weights differ from the file's."""
    if state.binding is None:
        return ""
    counts = changed_rows(state)
    if counts is None:
        return "Computed weights."
    if not counts:
        return "The file's weights, unchanged."
    which = ", ".join(f"{title} {number:,}" for title, number in counts.items())
    return f"{count(sum(counts.values()), 'vertex', 'differ')} from the file: {which}."


def changed_rows(state: State) -> dict[str, int] | None:
    """Return how many vertices differ from the file by each layer, the topmost first, and below.

    None where the file has no weights.
    """
    rig, binding = state.rig, state.binding
    if rig.weights is None or rig.weights.shape != binding.rows.shape:
        return None
    from_own = from_rig = _rows_differ(binding.rows, file_rows(state))
    if state.repair is not None and state.repair.codes:
        own_weights = applied(state.own, None, state.edits).weights
        if own_weights is None or own_weights.shape != binding.rows.shape:
            return None
        from_own = _rows_differ(binding.rows, csr_array(own_weights))
    differs = from_own.copy()
    counts: Counter[str] = Counter()
    for layer in reversed(state.edits.layers):
        if not layer.is_reach:
            rows = vertices_of([layer], binding.graph, len(differs))
            counts[layer.title] += int(differs[rows].sum())
            differs[rows] = False
    repaired = differs & ~from_rig
    counts["Repaired"] += int(repaired.sum())
    counts[COMPUTED] += int((differs & ~repaired).sum())
    return {title: number for title, number in counts.items() if number}


def loss(state: State) -> str:
    """Warn where an export replaces more than was edited."""
    if state.edits.base == "file" or not state.edits.layers or state.binding is None:
        return ""
    number = (changed_rows(state) or {}).get(COMPUTED, 0)
    if not number:
        return ""
    rows = count(number, "vertex")
    return f"The export also replaces {rows} that were not edited. From file keeps them."


def _rows_differ(one: csr_array, other: csr_array) -> NDArray[np.bool_]:
    """Return the vertices with other weights; one, other (n, j)."""
    differs: NDArray[np.bool_] = abs(one - other).max(axis=1).toarray().ravel() > SAME_WEIGHT
    return differs


def page(state: State) -> Callable[..., str]:
    """Return a function that makes the interactive page, which opens on the current panel."""
    view = state.panel if state.panel in VIEWS else "weights"
    return partial(interactive_page, view=view, colormap=state.colormap)


def _described(state: State) -> str:
    """Describe the content of the exported file."""
    rig, edits = state.rig, state.edits
    if rig is None or keeps_document(rig):
        moved = any(one.position is not None for one in edits.joints.values())
        changed = ["weights"]
        changed += ["skeleton"] if moved or edits.structural else []
        changed += ["mesh"] if state.own is not None and rig.mesh is not state.own.mesh else []
        summary = f"Only {' and '.join(changed)} of the GLB change."
    elif has_materials(rig):
        summary = "A new GLB: mesh, skeleton, weights, clips and base colours."
    else:
        summary = "A new GLB: mesh, skeleton, weights and clips, no materials."
    return f"{summary} Images show the current view."


def _offering(act: Callable[..., None], *arguments: Any) -> Callable[[Session], None]:
    """Return a function that starts an export and offers its file to the browser."""
    return lambda session: act(session, *arguments, session.view.offer)


def _is_empty(state: State) -> bool:
    return state.rig is None


FILMS = {
    "Interactive page (HTML)": lambda session: actions.export_interactive(
        session, page(session.state), session.view.offer
    ),
    "Picture (PNG)": _offering(actions.export_picture),
    "Turntable (MP4)": _offering(actions.export_turntable, "mp4"),
    "Turntable (GIF)": _offering(actions.export_turntable, "gif"),
    "Motion (MP4)": _offering(actions.export_motion, "mp4"),
    "Motion (GIF)": _offering(actions.export_motion, "gif"),
    "Moving cut or wavefront (MP4)": _offering(actions.export_sweep, "mp4"),
    "Moving cut or wavefront (GIF)": _offering(actions.export_sweep, "gif"),
}
NUMBERS = {
    "Weights (CSV)": _offering(actions.export_numbers, "weights", "csv"),
    "Distances (CSV)": _offering(actions.export_numbers, "distances", "csv"),
    "Both, with names (NPZ)": _offering(actions.export_numbers, "all", "npz"),
    "Nodes and edges of the graph (CSV)": _offering(actions.export_graph, "zip"),
    "Nodes and edges of the graph (NPZ)": _offering(actions.export_graph, "npz"),
}
CODE: dict[str, Callable[[Session], Any]] = {
    "Copy as Python": copy_script,
    "Copy as command": copy_command,
}
BASE = ui.section(
    "",
    ui.choice(
        "",
        "Base, below all layers",
        options=WHOSE,
        value=lambda state: state.edits.base == "file",
        act=correct.choose_file,
        visible=lambda state: ui.has_weights(state) and not state.bare,
        disabled=lambda state: state.graph is None,
    ),
    ui.caption(changes_of, late=LATE),
    ui.caption(loss, late=LATE, sx={**ui.QUIET, "color": "warning.main"}),
)
EXPORT = ui.folded(
    "Export",
    ui.button(
        "Export GLB",
        _offering(actions.export_bound),
        icon="download",
        disabled=lambda state: _is_empty(state) or state.bare,  # it waits for weights
        variant="contained",
    ),
    ui.row(
        ui.menu("Image, video", "movie", FILMS, margin=ui.BESIDE, disabled=_is_empty),
        ui.menu("Data", "table_chart", NUMBERS, disabled=_is_empty),
    ),
    ui.menu("Code", "code", CODE, disabled=_is_empty),
    ui.caption(_described),
)
