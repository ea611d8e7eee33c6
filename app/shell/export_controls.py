"""Export: the character with its new weights, pictures, films, numbers."""

from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cutcell.editing.binding_warnings import SAME
from cutcell.io import keeps_document
from cutcell.io.materials.transfer import has_materials
from cutcell.runtime.display import count

from ..document.session import Session
from ..document.state import State
from ..features.correct import commands as correct
from ..features.layers.stack import painted_vertices
from ..headless.interactive import VIEWS, interactive_page
from ..widgets import controls as ui
from . import export as actions
from .export_code import copy_command, copy_script

WHOSE = {"From file": True, "Computed": False}
"""The base below all layers."""


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
    painted[painted_vertices(state.edits)] = True
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


def _described(state: State) -> str:
    """Return what the exported file contains."""
    rig, edits = state.rig, state.edits
    if rig is None or keeps_document(rig):
        moved = any(one.position is not None for one in edits.joints.values())
        changed = ["weights"]
        changed += ["skeleton"] if moved or edits.structural else []
        changed += ["mesh"] if state.repair is not None else []
        summary = f"Only {' and '.join(changed)} of the GLB change."
    elif has_materials(rig):
        summary = "A new GLB: mesh, skeleton, weights, clips and base colours."
    else:
        summary = "A new GLB: mesh, skeleton, weights and clips, no materials."
    return f"{summary} Images show the current view."


def _offering(act: Callable[..., None], *arguments: Any) -> Callable[[Session], None]:
    """Return what starts an export that offers its file to the browser."""
    return lambda session: act(session, *arguments, session.view.offer)


def _is_empty(state: Any) -> bool:
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
    "Sweep (MP4)": _offering(actions.export_sweep, "mp4"),
    "Sweep (GIF)": _offering(actions.export_sweep, "gif"),
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
EXPORT = ui.folded(
    "Export",
    ui.choice(
        "",
        options=WHOSE,
        value=correct.uses_file,
        act=correct.choose_file,
        visible=lambda state: ui.has_weights(state) and not state.bare,
        disabled=lambda state: state.graph is None,
    ),
    ui.caption(changes_of, late=("rig", "binding", "repair", "edits")),
    ui.button(
        "Export GLB",
        _offering(actions.export_bound),
        icon="download",
        disabled=lambda state: state.binding is None,
        variant="contained",
    ),
    ui.row(
        ui.menu("Image, video", "movie", FILMS, margin=ui.BESIDE, disabled=_is_empty),
        ui.menu("Data", "table_chart", NUMBERS, disabled=_is_empty),
    ),
    ui.menu("Code", "code", CODE, disabled=_is_empty),
    ui.caption(_described),
)
