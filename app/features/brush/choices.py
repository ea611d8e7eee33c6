"""Choices of the brush that paints weights."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, get_args

import numpy as np
import param
from numpy.typing import NDArray

from cutcell.rig import TriangleMesh

from ...document.kinds import MOMENT
from ...editing.stroke import BrushMode

MIN_RADIUS, MAX_RADIUS = 0.005, 0.5
"""Radius of the brush, relative to the character's longest side."""
MIN_STRENGTH = 0.05


@dataclass(frozen=True, eq=False)
class Selection:
    """Vertices of a mesh that strokes are limited to.

    Parameters
    ----------
    mesh : TriangleMesh
    chosen : array, shape (n,), bool
    """

    mesh: TriangleMesh
    chosen: NDArray[np.bool_]


class Choices(param.Parameterized):
    """Whether there is a brush, and what it does."""

    brush = param.Boolean(False, label="Paint")
    brush_mode: param.Selector[str] = param.Selector(
        default="add",
        objects={mode.capitalize(): mode for mode in (*get_args(BrushMode), "select")},
    )
    brush_radius = param.Number(
        0.06, bounds=(MIN_RADIUS, MAX_RADIUS), step=0.005, label="Radius (% of size)",
        doc="Part of the character's longest side.",
    )  # fmt: skip
    brush_strength = param.Number(0.5, bounds=(MIN_STRENGTH, 1), step=0.05, label="Strength")
    brush_value = param.Number(1.0, bounds=(0, 1), step=0.05, label="Weight to paint")
    brush_mirrored = param.Boolean(False, label="Mirror")
    brush_selection: Any = param.Parameter(
        None, doc="The `Selection` that strokes are limited to, of whatever mesh; or None."
    )


BRUSH = frozenset(Choices.param) - {"name"}
"""Tools are chosen, but are no choices: undo takes strokes back, not the brush."""
for one in BRUSH:
    Choices.param[one].precedence = MOMENT


def selected(state: Any) -> NDArray[np.bool_] | None:
    """Return which vertices strokes are limited to, shape (n,); None for no limit."""
    selection = state.brush_selection
    if selection is None or state.rig is None or selection.mesh is not state.rig.mesh:
        return None
    chosen: NDArray[np.bool_] = selection.chosen
    return chosen if chosen.any() else None


def selected_vertices(state: Any) -> NDArray[np.intp]:
    """Return the selected vertices, shape (k,); none without a selection."""
    chosen = selected(state)
    return np.flatnonzero([] if chosen is None else chosen)
