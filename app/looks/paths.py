"""Shortest path from the clicked vertex to the chosen bone."""

from typing import Any

from cutcell.geodesics import trace_path

from ..document.state import State


def path_of(state: State) -> Any:
    """Return the shortest path from the clicked vertex to the bone (p, 3), or None."""
    field = state.field
    if not state.path or state.vertex is None or field is None:
        return None
    inputs = state.binding.distances, state.joint, state.vertex, field
    return state.memo("path", inputs, lambda: trace_path(*inputs).points)
