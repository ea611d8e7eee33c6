"""Export: the character with its new weights, pictures, films, numbers."""

from collections.abc import Callable

import panel_material_ui as pmui

from cutcell.io import keeps_document
from cutcell.io.materials.transfer import has_materials
from cutcell.rig import Rig

from ..commands import export as actions
from ..commands.session import Session
from .controls import BESIDE, button, caption, menu, row, section, when


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
        "Picture (PNG)": lambda: actions.export_picture(session, offer),
        "Turntable (MP4)": lambda: actions.export_turntable(session, "mp4", offer),
        "Turntable (GIF)": lambda: actions.export_turntable(session, "gif", offer),
        "Motion (MP4)": lambda: actions.export_motion(session, "mp4", offer),
        "Motion (GIF)": lambda: actions.export_motion(session, "gif", offer),
    }
    numbers: dict[str, Callable[[], None]] = {
        "Weights (CSV)": lambda: actions.export_numbers(session, "weights", "csv", offer),
        "Distances (CSV)": lambda: actions.export_numbers(session, "distances", "csv", offer),
        "Both, with names (NPZ)": lambda: actions.export_numbers(session, "all", "npz", offer),
        "Nodes and edges of the graph (CSV)": lambda: actions.export_graph(session, "zip", offer),
        "Nodes and edges of the graph (NPZ)": lambda: actions.export_graph(session, "npz", offer),
    }
    empty = when(lambda rig: rig is None, state.param.rig)
    return section(
        "Export",
        bound,
        row(
            menu("Picture, film", "movie", films, margin=BESIDE, disabled=empty),
            menu("Numbers", "table_chart", numbers, disabled=empty),
        ),
        caption(when(_described, state.param.rig)),
    )


def _described(rig: Rig | None) -> str:
    """Say what the bound file holds."""
    if rig is None or keeps_document(rig):
        summary = "The GLB is as it was, but for the weights."
    elif has_materials(rig):
        summary = "The GLB is a new one: mesh, skeleton, weights, motions and base colours."
    else:
        summary = "The GLB is a new one: mesh, skeleton, weights and motions, without materials."
    return f"{summary} Images show the current view."
