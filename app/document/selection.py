"""Selected vertices of the open character."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from cutcell.rig import TriangleMesh

from .state import State


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


def selected(state: State) -> NDArray[np.bool_] | None:
    """Return which vertices strokes are limited to, shape (n,); None for no limit."""
    selection = state.brush_selection
    if selection is None or state.rig is None or selection.mesh is not state.rig.mesh:
        return None
    chosen: NDArray[np.bool_] = selection.chosen
    return chosen if chosen.any() else None


def selected_vertices(state: State) -> NDArray[np.intp]:
    """Return the selected vertices, shape (k,); none without a selection."""
    chosen = selected(state)
    return np.flatnonzero([] if chosen is None else chosen)
