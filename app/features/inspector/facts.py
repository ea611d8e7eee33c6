"""Facts about one vertex or node, for its card."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from cutcell.geodesics import FALLBACK_REASONS
from cutcell.graph.winding import winding_number
from cutcell.runtime.display import shown_name
from cutcell_viewers.distance_scene import unit_of
from cutcell_viewers.graph_scene import KINDS
from cutcell_viewers.joint_colors import colors_of
from cutcell_viewers.palette import to_hex
from cutcell_viewers.short_names import short_names

from ...document.side_by_side import NOW
from ...document.state import State
from ...editing.compute.stack import painted_vertices
from ...looks.components import components
from ...looks.explanation import explanation_facts
from ...looks.methods import title_of, weights_of

MAX_WEIGHTS = 6
MAX_DISTANCES = 5
MIN_OFFERED = 4
MAX_NEIGHBOURS = 26
"""Number of neighbours of a node that are listed, the nearest first."""
NO_WEIGHT = 5e-3
"""Weights that would be shown as 0.00 are not shown."""


def vertex_facts(state: State) -> dict[str, Any] | None:
    """Return the content of the chosen vertex's card; None if none is chosen.

    Returns
    -------
    dict or None
        "vertex", "computed"; once it is bound also "weights" and "distances" (lists of bones, the
        most important first), "component", "reached", "reason", "artist" (whether the file has
        weights), "explain" (whether explanations are on), "why" (the explanation for each joint,
        see `explanation_facts`), "overruled" (whether its weights were set by a person) and
        "offered" (joints whose weight can be set). Lengths are in the file's units, whose name is
        "unit". On the panel Compare "method" names the method that was clicked; only the page's
        own has distances and an explanation.
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
    colors = state.memo("colors", (rig,), lambda: colors_of(rig))
    shorts = state.memo("short names", (rig.skeleton,), lambda: short_names(rig.skeleton.names))

    def bone(joint: int, **values: Any) -> dict[str, Any]:
        name, color = shown_name(rig.skeleton.names[joint]), to_hex(tuple(colors[joint]))
        return {"joint": int(joint), "name": name, "short": shorts[joint], "color": color, **values}

    row = np.asarray(weights[vertex])
    artist = None if rig.weights is None or method == "artist" else rig.weights[vertex]
    either = row if artist is None else np.maximum(row, artist)
    listed = [j for j in np.argsort(-either, kind="stable")[:MAX_WEIGHTS] if either[j] > NO_WEIGHT]
    which, sizes = state.memo("components", (binding.graph,), lambda: components(binding.graph))
    component = int(which[vertex])
    facts |= {
        "artist": artist is not None,
        "weights": [
            bone(j, ours=float(row[j]), artist=0.0 if artist is None else float(artist[j]))
            for j in listed
        ],
        "component": {"number": component + 1, "of": len(sizes), "vertices": int(sizes[component])},
    }
    if method != NOW:
        return facts
    distance = binding.distances.at(slice(None), vertex) * binding.graph.lattice.size
    near = dict.fromkeys([*np.argsort(distance, kind="stable")[:MAX_DISTANCES], state.joint])
    fallback = int(binding.distances.fallback[vertex])
    return {
        **facts,
        "unit": unit_of(rig),
        "distances": [bone(j, distance=float(distance[j])) for j in near if distance[j] < np.inf],
        "reached": fallback == 0,
        "reason": FALLBACK_REASONS[fallback],
        "explain": state.explain,
        "why": [bone(j, **details) for j, details in explanation_facts(state).items()],
        "overruled": vertex in painted_vertices(state.edits),
        "offered": [bone(j, weight=float(row[j])) for j in _offered(state, row, distance)]
        if state.explain
        else [],
    }


def _method_of(state: State) -> str:
    """Return the method of the card: the clicked one on the panel Compare, else the page's."""
    if state.panel != "compare":
        return NOW
    return state.clicked_method if state.clicked_method in state.methods else state.methods[0]


def _offered(state: State, weights: NDArray, distance: NDArray) -> list[int]:
    """Return the joints whose weight can be set: with weight, the chosen one, the nearest."""
    allowed = np.ones(len(weights), bool)
    if state.rig.allowed is not None:
        allowed = state.rig.allowed[state.vertex]
    weighted = [j for j in np.argsort(-weights, kind="stable").tolist() if weights[j] > 0]
    near = [j for j in np.argsort(distance, kind="stable").tolist() if distance[j] < np.inf]
    joints = dict.fromkeys([*weighted, state.joint, *near])
    return [j for j in joints if allowed[j]][: max(len(weighted) + 1, MIN_OFFERED)]


def node_facts(state: State) -> dict[str, Any] | None:
    """Return the content of the chosen node's card; None if none is chosen.

    Returns
    -------
    dict or None
        "node", "kind", "position" (in the file's units, "unit"), "winding", "neighbours" (number,
        kind, kind of the edge, length in the file's units), "degree", "triangle" (its face and that
        face's corners, of a surface node) and "vertices" (of a mesh node).
    """
    graph, node = state.shown_graph, state.node
    if state.panel != "graph" or graph is None or node is None or node >= len(graph.nodes):
        return None
    indptr, indices, lengths = graph.adjacency
    around = slice(indptr[node], indptr[node + 1])
    near = sorted(zip(lengths[around].tolist(), indices[around].tolist(), strict=True))
    kinds, size, mesh = graph.node_kind, graph.lattice.size, state.rig.mesh
    position = graph.lattice.to_file(graph.nodes[node][None])
    face = int(graph.triangle[node])
    return {
        "node": int(node),
        "unit": unit_of(state.rig),
        "kind": KINDS[kinds[node]],
        "position": position[0].tolist(),
        "winding": state.memo(
            "node winding", (graph, node), lambda: float(winding_number(mesh, position)[0])
        ),
        "degree": len(near),
        "neighbours": [
            {"node": other, "kind": KINDS[kinds[other]], "length": length * size}
            for length, other in near[:MAX_NEIGHBOURS]
        ],
        "triangle": None if face < 0 else [face, *mesh.faces[face].tolist()],
        "vertices": np.flatnonzero(graph.vertex_node == node)[:8].tolist(),
    }
