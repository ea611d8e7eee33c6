"""Facts about one vertex: a pure function of the state."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from cutcell.geodesics import FALLBACK_REASONS
from cutcell.graph.winding import winding_number
from cutcell.runtime.display import shown_name
from cutcell_viewers.graph_scene import KINDS
from cutcell_viewers.joint_colors import colors_of
from cutcell_viewers.palette import to_hex
from cutcell_viewers.short_names import short_names

from ..state import State
from ..state.compare import NOW
from .compare import title_of, weights_of
from .components import components
from .explain import explanation_facts
from .memo import Memo

MAX_WEIGHTS = 6
MAX_DISTANCES = 5
MIN_OFFERED = 4
NO_WEIGHT = 5e-3
"""Weights that would be shown as 0.00 are not shown."""


def vertex_facts(state: State, memo: Memo) -> dict[str, Any] | None:
    """Return what the inspector shows of the chosen vertex; None if none is chosen.

    Returns
    -------
    dict or None
        "vertex", "computed"; once it is bound also "weights" and "distances" (a list of bones
        each, the most important first), "component", "reached", "reason"; and "artist",
        whether the file has weights; "explain", whether it is asked why, and "why", the
        answer for each joint, once it is there (see `explanation_facts`); "overruled", whether
        a person gave it its weights, and "offered", joints that it may be given weight of.
        Lengths are in the file's units. Beside other methods "method" names the one that was
        clicked; only the page's own has distances and an explanation.
    """
    rig, binding, vertex = state.rig, state.binding, state.vertex
    if rig is None or vertex is None or vertex >= len(rig.mesh.vertices):
        return None
    method = _method_of(state)
    weights = weights_of(state, method)
    computed = binding is not None and weights is not None
    facts: dict[str, Any] = {"vertex": int(vertex), "computed": computed}
    if state.panel == "compare":
        facts["method"] = title_of(method)
    if not computed:
        return facts
    colors = memo("colors", (rig,), lambda: colors_of(rig))
    shorts = memo("short names", (rig.skeleton,), lambda: short_names(rig.skeleton.names))

    def bone(joint: int, **values: Any) -> dict[str, Any]:
        color = to_hex(tuple(colors[joint]))
        return {
            "joint": int(joint),
            "name": shown_name(rig.skeleton.names[joint]),
            "short": shorts[joint],
            "color": color,
            **values,
        }

    own = np.asarray(weights[vertex])
    artist = None if rig.weights is None or method == "artist" else rig.weights[vertex]
    either = own if artist is None else np.maximum(own, artist)
    listed = [j for j in np.argsort(-either, kind="stable")[:MAX_WEIGHTS] if either[j] > NO_WEIGHT]
    which, sizes = memo("components", (binding.graph,), lambda: components(binding.graph))
    component = int(which[vertex])
    facts |= {
        "artist": artist is not None,
        "weights": [
            bone(j, ours=float(own[j]), artist=0.0 if artist is None else float(artist[j]))
            for j in listed
        ],
        "component": {"number": component + 1, "of": len(sizes), "vertices": int(sizes[component])},
    }
    if method != NOW:
        return facts
    distance = binding.distances.at(slice(None), vertex) * binding.graph.lattice.size
    near = [j for j in np.argsort(distance, kind="stable")[:MAX_DISTANCES]]
    fallback = int(binding.distances.fallback[vertex])
    return {
        **facts,
        "distances": [bone(j, distance=float(distance[j])) for j in near if distance[j] < np.inf],
        "reached": fallback == 0,
        "reason": FALLBACK_REASONS[fallback],
        "explain": state.explain,
        "why": [bone(j, **details) for j, details in explanation_facts(state).items()],
        "overruled": vertex in state.corrections.vertices,
        "offered": [bone(j, weight=float(own[j])) for j in _offered(state, own, distance)]
        if state.explain
        else [],
    }


def _method_of(state: State) -> str:
    """Return the method that the card shows: the one clicked beside others, else the page's."""
    if state.panel != "compare":
        return NOW
    return state.clicked_method if state.clicked_method in state.methods else state.methods[0]


def _offered(state: State, weights: NDArray, distance: NDArray) -> list[int]:
    """Return what may be given weight: joints with some, the chosen bone, the nearest others."""
    allowed = np.ones(len(weights), bool)
    if state.rig.allowed is not None:
        allowed = state.rig.allowed[state.vertex]
    weighted = [j for j in np.argsort(-weights, kind="stable").tolist() if weights[j] > 0]
    near = [j for j in np.argsort(distance, kind="stable").tolist() if distance[j] < np.inf]
    joints = dict.fromkeys([*weighted, state.joint, *near])
    return [j for j in joints if allowed[j]][: max(len(weighted) + 1, MIN_OFFERED)]


MAX_NEIGHBOURS = 26
"""How many neighbours of a node are listed, the nearest first."""


def node_facts(state: State, memo: Memo) -> dict[str, Any] | None:
    """Return what the inspector shows of the chosen node of the graph; None if none is chosen.

    Returns
    -------
    dict or None
        "node", "kind", "position" (in the file's units), "winding", "neighbours" (number, kind,
        kind of the edge, length in the file's units), "degree", "triangle" (its face and that
        face's corners, of a surface node) and "vertices" (of a mesh node).
    """
    graph, node = state.shown_graph, state.node
    if state.panel != "graph" or graph is None or node is None or node >= len(graph.nodes):
        return None
    indptr, indices, lengths = graph.adjacency
    around = slice(indptr[node], indptr[node + 1])
    near = sorted(zip(lengths[around].tolist(), indices[around].tolist(), strict=True))
    position = graph.lattice.to_file(graph.nodes[node][None])[0]
    face = int(graph.triangle[node])
    return {
        "node": int(node),
        "kind": KINDS[graph.node_kind[node]],
        "position": [float(x) for x in position],
        "winding": memo("node winding", (graph, node), lambda: _winding(state, position)),
        "degree": len(near),
        "neighbours": [
            {
                "node": other,
                "kind": KINDS[graph.node_kind[other]],
                "length": length * graph.lattice.size,
            }
            for length, other in near[:MAX_NEIGHBOURS]
        ],
        "triangle": None if face < 0 else [face, *state.rig.mesh.faces[face].tolist()],
        "vertices": np.flatnonzero(graph.vertex_node == node)[:8].tolist(),
    }


def _winding(state: State, position: NDArray[np.float64]) -> float:
    return float(winding_number(state.rig.mesh, position[None])[0])
