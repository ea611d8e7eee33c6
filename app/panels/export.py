"""Export: the character with its new weights, pictures, films, numbers."""

from collections.abc import Callable
from functools import partial

import panel_material_ui as pmui

from cutcell.editing.corrections import Corrections
from cutcell.io import keeps_document
from cutcell.io.materials.transfer import has_materials
from cutcell.rig import Rig

from ..commands import export as actions
from ..commands.session import Session
from ..standalone.page import VIEWS, interactive_page
from ..state import State
from .controls import BESIDE, button, caption, folded, menu, row, when


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
    empty = when(lambda rig: rig is None, state.param.rig)
    return folded(
        "Export",
        bound,
        row(
            menu("Image, video", "movie", films, margin=BESIDE, disabled=empty),
            menu("Data", "table_chart", numbers, disabled=empty),
        ),
        caption(when(_described, state.param.rig, state.param.corrections, state.param.repair)),
    )


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
