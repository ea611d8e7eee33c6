"""How figures of tables look."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

INK, FAINT = "#22262d", "#d9dde3"
METHOD_COLORS = {
    "cutcell": "#eda35f",
    "cutcell_any": "#d9660a",
    "cutcell_rig": "#8f3f00",
    "visibility": "#7d5ba6",
    "voxel": "#3f6fa3",
    "voxel_unirig": "#93b3d4",
}
STAGE_COLORS = {
    "graph": "#4c9a4c",
    "cage": "#4c9a4c",
    "tetrahedra": "#4c9a4c",
    "distances": "#3f6fa3",
    "weights": "#d9660a",
}


def styled(rows: int, columns: int, size: tuple[float, float]) -> tuple[Figure, list[Any]]:
    """Return a white figure of quiet axes, and these in order."""
    figure = Figure(figsize=size, facecolor="white")
    FigureCanvasAgg(figure)
    axes = list(np.atleast_1d(figure.subplots(rows, columns)).ravel())
    for panel in axes:
        panel.grid(axis="y", color=FAINT, linewidth=0.7)
        panel.set_axisbelow(True)
        panel.tick_params(length=0, labelsize=8.5, colors=INK)
        for side in panel.spines.values():
            side.set_visible(False)
    return figure, axes


def save(figure: Figure, path: Path, bottom: float = 0.0) -> None:
    """Write a figure, with a margin below the axes."""
    figure.tight_layout(rect=(0, bottom, 1, 1))
    figure.savefig(path, dpi=150, facecolor="white")
