"""Rigid accessories: small components without bones follow what they are attached to."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array

from ...bones.nearest import NodeGrid
from ...geometry.vectors import TIE
from ...graph import CutCellGraph
from ...rig.rows import scaled, single, strongest, with_rows
from .components import MAX_RIGID_SIZE
from .containment import ramp

CONTACT_CELLS = 1.0
"""Lattice cells: an accessory touches the body wherever it is at most this much farther from it
than at its nearest vertex."""
OWN_PART = 0.5
"""An accessory's own weights count this much beside those of what it touches."""
DOMINANT = 0.6, 0.9
"""An accessory follows one joint alone that has the second part of these weights, or is the
strongest on as much of the surface; up to the first, the mean of the weights."""


def attach_accessories(
    graph: CutCellGraph,
    containment: NDArray[np.float64],
    weights: csr_array,
    own: csr_array,
    independent: NDArray[np.bool_],
) -> csr_array:
    """Make small components without bones rigid: eyes, buttons, horns, armour.

    Each moves rigidly, by the mean weights of the rest of the mesh where they touch and by its own.

    Shapes: containment (components, j), weights, own (k, j), independent (components,); returns
    (k, j).
    """
    component, areas = graph.mesh.component, graph.mesh.areas
    # A component without area, such as a vertex without a face, touches nothing.
    has_area = np.bincount(component, areas, len(containment)) > 0
    is_small = graph.mesh.longest_sides <= MAX_RIGID_SIZE
    is_accessory = has_area & is_small & (containment.max(axis=1) == 0) & ~independent
    if not is_accessory.any():
        return weights
    on_body = ~is_accessory[component]
    # A mesh that is in patches all over is no body with things on it.
    if areas[on_body].sum() < areas.sum() / 2:
        return weights
    return attach(graph, is_accessory, weights, own)


def attach(
    graph: CutCellGraph,
    is_accessory: NDArray[np.bool_],
    weights: csr_array,
    own: csr_array | None = None,
) -> csr_array:
    """Make some components, shape (components,), rigid to the others where they touch them.

    With their `own` weights, which then count besides, they also touch each other.

    `weights`, `own` and what is returned have the shape (k, j).
    """
    points, component, areas = graph.mesh.points, graph.mesh.component, graph.mesh.areas
    attached = np.flatnonzero(is_accessory[component])
    label, area = component[attached], areas[attached] + 1e-12
    if own is None:
        distance, mean = nearest_on_body(graph, ~is_accessory[component], points[attached])
    else:
        every = np.ones(len(component), np.bool_)
        distance, mean = nearest_on_body(graph, every, points[attached], label)
    least = np.full(len(is_accessory), np.inf)
    np.minimum.at(least, label, distance)
    touches = distance <= least[label] + CONTACT_CELLS / graph.lattice.resolution + TIE
    rows, share = _averages(mean @ weights, area * touches, label, len(is_accessory))
    if own is not None:
        own_rows, own_share = _averages(own[attached], area, label, len(is_accessory))
        rows = (rows + OWN_PART * own_rows) / (1 + OWN_PART)
        share = (share + OWN_PART * own_share) / (1 + OWN_PART)
    alone = ramp(share.max(axis=1).toarray(), *DOMINANT)
    rows = scaled(rows, 1 - alone) + scaled(single(strongest(share), weights.shape[1]), alone)
    return with_rows(weights, attached, rows[label])


def _averages(
    weights: csr_array, areas: NDArray[np.float64], component: NDArray[np.int32], components: int
) -> tuple[csr_array, csr_array]:
    """Average weights (c, j) over each component, and their joints' shares: (components, j).

    A share is at least the part of the area on which the joint is the strongest.
    """
    gather = csr_array((areas, (component, np.arange(len(component)))), (components, len(areas)))
    gather = scaled(gather, 1 / np.maximum(gather.sum(axis=1), 1e-300))
    mean = csr_array(gather @ weights)
    mean.sort_indices()
    return mean, mean.maximum(gather @ single(strongest(weights), weights.shape[1]))


def nearest_on_body(
    graph: CutCellGraph,
    on_body: NDArray[np.bool_],
    points: NDArray[np.float64],
    apart: NDArray[np.integer] | None = None,
) -> tuple[NDArray[np.float64], csr_array]:
    """Measure from points to the body's surface: its vertices, and where rays hit it.

    A component of the body is no part of it for points that are in it, by `apart` (p,).

    Returns the distances (p,), and the matrix (p, k) that makes weights of welded vertices the
    weights at the points: the means over the corners of the faces that their nearest nodes are on.
    """
    first = graph.first_surface
    vertex = np.append(np.arange(len(on_body)), graph.faces[graph.triangle[first:], 0])
    on_surface = np.append(np.arange(len(on_body)), np.arange(first, len(graph.nodes)))
    chosen, label = np.zeros(len(graph.nodes), np.bool_), np.zeros(len(graph.nodes), np.int32)
    chosen[on_surface], label[on_surface] = on_body[vertex], graph.mesh.component[vertex]
    of, node = NodeGrid(graph.nodes, chosen, graph.lattice.resolution, label).nearest(points, apart)
    distance = np.linalg.norm(graph.nodes[node] - points[of], axis=1)
    corners = np.where(node[:, None] < first, node[:, None], graph.faces[graph.triangle[node]])
    part = np.repeat(1 / (3 * np.bincount(of)[of]), 3)
    mean = csr_array((part, (np.repeat(of, 3), corners.ravel())), (len(points), len(on_body)))
    return distance[np.searchsorted(of, np.arange(len(points)))], mean
