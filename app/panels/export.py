"""Export: the character with its new weights, pictures, films, numbers."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import panel_material_ui as pmui

from cutcell.io import keeps_document
from cutcell.io.materials.transfer import has_materials
from cutcell.rig import Rig

from ..commands import export as actions
from ..commands.session import Session
from .controls import GAP, caption, section, when


def export(session: Session) -> pmui.Column:
    """Return the section of the downloads."""
    state, offer = session.state, session.view.offer
    bound = pmui.Button(
        label="Export GLB",
        icon="download",
        size="small",
        margin=GAP,
        sizing_mode="stretch_width",
        on_click=lambda event: actions.export_bound(session, offer),
        disabled=when(lambda value: value is None, state.param.binding),
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
    return section(
        "Export",
        bound,
        pmui.Row(
            _menu("Image, video", "movie", films, state.param.rig, (4, 8, 4, 0)),
            _menu("Data", "table_chart", numbers, state.param.rig, GAP),
            margin=0,
            sizing_mode="stretch_width",
        ),
        caption(when(_described, state.param.rig)),
    )


def _described(rig: Rig | None) -> str:
    """Say what the bound file holds."""
    if rig is None or keeps_document(rig):
        summary = "The GLB keeps everything but the corrected data."
    elif has_materials(rig):
        summary = "A new GLB: mesh, skeleton, weights, clips and base colours."
    else:
        summary = "A new GLB: mesh, skeleton, weights and clips, no materials."
    return f"{summary} Images show the current view."


def _menu(
    label: str, icon: str, choices: dict[str, Callable[[], None]], needed: Any, margin: Any
) -> pmui.MenuButton:
    menu = pmui.MenuButton(
        label=label,
        icon=icon,
        items=[{"label": name} for name in choices],
        size="small",
        variant="outlined",
        margin=margin,
        sizing_mode="stretch_width",
        disabled=when(lambda value: value is None, needed),
    )

    def chosen(item: Any) -> None:
        choices[item["label"]]()

    menu.on_click(chosen)
    return menu
