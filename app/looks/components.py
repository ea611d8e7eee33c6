"""The connected components of the mesh: what each follows, and the one that is looked at."""

from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cutcell.graph import CutCellGraph
from cutcell_viewers.description import Actor

from ..document.state import State

DIMMED_OPACITY = 0.22
"""How opaque the body is beside a component that is looked at."""


def vertices_of(state: State, vertex: int) -> NDArray[np.intp]:
    """Return the vertices of the component that a vertex is of."""
    which, _ = components_of(state)
    return np.flatnonzero(which == which[vertex])


def chosen(state: State) -> int:
    """Return the number of the component that is looked at; -1 for none."""
    if state.part is None or state.binding is None:
        return -1
    return int(components_of(state)[0][state.part])


def seen_apart(state: State, actors: dict[str, Actor]) -> dict[str, Actor]:
    """Return actors in which the component that is looked at stands out from the body."""
    if chosen(state) < 0:
        return actors
    body = actors["body"]
    part = state.memo(
        "part", (body.cells, state.binding.graph, state.part), lambda: _faces(state, body)
    )
    alone = replace(body, cells=part, closed=False, opacity=1.0)
    dim: dict[str, Any] = {"opacity": DIMMED_OPACITY, "behind": True}
    return {**actors, "body": replace(body, **dim), "part": alone}


def _faces(state: State, body: Actor) -> NDArray:
    assert state.part is not None
    in_part = np.zeros(len(body.points), np.bool_)
    in_part[vertices_of(state, state.part)] = True
    assert body.cells is not None
    return np.ascontiguousarray(body.cells[in_part[body.cells].all(axis=1)])


def components_of(state: State) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
    graph = state.binding.graph
    edges: tuple[NDArray[np.intp], NDArray[np.intp]] = state.memo(
        "components", (graph,), lambda: components(graph)
    )
    return edges


def components(graph: CutCellGraph) -> tuple[NDArray[np.int32], NDArray[np.intp]]:
    """Return each vertex's connected component (n,), the largest being 0, and their sizes (c,)."""
    which = graph.mesh.component[graph.vertex_node]
    return which, np.bincount(which)
