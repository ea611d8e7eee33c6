"""The connected components of the mesh: what each follows, and the one that is looked at."""

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_array

from cutcell.editing import Layer
from cutcell.graph import CutCellGraph
from cutcell.runtime.display import shown_name
from cutcell_viewers.description import Actor

from ...derive.memo import Memo
from ...document.state import State
from ..layers.stack import part_layers

MOST = 300
"""Components that are listed, the largest first."""
DIMMED_OPACITY = 0.22
"""How opaque the body is beside a component that is looked at."""


@dataclass(frozen=True)
class Component:
    """A connected component.

    Parameters
    ----------
    number : int
        The largest is 0.
    first : int
        Its first vertex.
    vertices : int
        How many it has.
    name : str
        Of the file's mesh that it is a part of, where there are several; else empty.
    joint : int
        That it follows most.
    share : float
        How much of its weight that joint has.
    layer : Layer or None
        That binds this component.
    """

    number: int
    first: int
    vertices: int
    name: str
    joint: int
    share: float
    layer: Layer | None


def vertices_of(state: State, memo: Memo, vertex: int) -> NDArray[np.intp]:
    """Return the vertices of the component that a vertex is of."""
    which, _ = _components(state, memo)
    return np.flatnonzero(which == which[vertex])


def listed(state: State, memo: Memo) -> list[Component]:
    """Return the components, the largest first; none until the character is bound."""
    if state.binding is None:
        return []
    which, sizes = _components(state, memo)
    firsts = memo("first vertices", (which,), lambda: np.unique(which, return_index=True)[1])
    layers = {int(which[v]): layer for v, layer in part_layers(state.edits).items()}
    weights = state.binding.weights
    mean_weights = memo("of parts", (which, weights), lambda: _mean(which, weights, len(sizes)))
    names = {} if len(state.rig.parts) < 2 else state.rig.parts
    starts = [part.vertices.start for part in names]
    return [
        Component(
            number=k,
            first=int(firsts[k]),
            vertices=int(sizes[k]),
            name=shown_name(names[np.searchsorted(starts, firsts[k], "right") - 1].name)
            if names
            else "",
            joint=int(mean_weights[k].argmax()),
            share=float(mean_weights[k].max()),
            layer=layers.get(k),
        )
        for k in range(min(len(sizes), MOST))
    ]


def chosen(state: State, memo: Memo) -> int:
    """Return the number of the component that is looked at; -1 for none."""
    if state.part is None or state.binding is None:
        return -1
    return int(_components(state, memo)[0][state.part])


def seen_apart(state: State, memo: Memo, actors: dict[str, Actor]) -> dict[str, Actor]:
    """Return actors in which the component that is looked at stands out from the body."""
    if chosen(state, memo) < 0:
        return actors
    body = actors["body"]
    part = memo(
        "part", (body.cells, state.binding.graph, state.part), lambda: _faces(state, memo, body)
    )
    alone = replace(body, cells=part, closed=False, opacity=1.0)
    dim: dict[str, Any] = {"opacity": DIMMED_OPACITY, "behind": True}
    return {**actors, "body": replace(body, **dim), "part": alone}


def _faces(state: State, memo: Memo, body: Actor) -> NDArray:
    assert state.part is not None
    in_part = np.zeros(len(body.points), np.bool_)
    in_part[vertices_of(state, memo, state.part)] = True
    assert body.cells is not None
    return np.ascontiguousarray(body.cells[in_part[body.cells].all(axis=1)])


def _components(state: State, memo: Memo) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
    graph = state.binding.graph
    edges: tuple[NDArray[np.intp], NDArray[np.intp]] = memo(
        "components", (graph,), lambda: components(graph)
    )
    return edges


def _mean(which: NDArray[np.intp], weights: NDArray, count: int) -> NDArray[np.float64]:
    member = coo_array((np.ones(len(which)), (which, np.arange(len(which)))), (count, len(which)))
    mean: NDArray[np.float64] = (member @ weights) / np.bincount(which, minlength=count)[:, None]
    return mean


def components(graph: CutCellGraph) -> tuple[NDArray[np.int32], NDArray[np.intp]]:
    """Return each vertex's connected component (n,), the largest being 0, and their sizes (c,)."""
    which = graph.mesh.component[graph.vertex_node]
    return which, np.bincount(which)
