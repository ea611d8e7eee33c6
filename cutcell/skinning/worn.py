"""Pieces of a mesh: limbs that hold bones of their own, and what is worn without any."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array

from ..compiled import lean
from ..geodesics.bones import TIE
from ..geodesics.nearest import NodeGrid
from ..graph import CutCellGraph
from .skin import Skin

FOREIGN = 2.0
"""How many times farther a bone counts to be, beyond once, from a piece that it is not in while
it is in another."""
SMALL = 0.25
"""Of the longest side: a piece up to this large may be something worn."""
CONTACT = 1.0
"""Lattice cells: a worn piece touches its wearer wherever it is this much farther than at its
nearest."""
RIGID = 0.6
"""A worn piece follows one joint alone if its wearer does by this much where they touch, or if
that joint leads at so much of what they touch."""


def foreign_bones(held: NDArray[np.float64]) -> NDArray[np.float64]:
    """Tell how many times farther each joint counts to be from each piece of the mesh.

    An arm whose mesh is a piece of its own reaches into the shoulder, and its bone with it; the
    chest's skin there is not the arm's. A piece is home to a bone that is mostly in it, and to
    the one that is most in it.

    Parameters
    ----------
    held : array, shape (pieces, j)
        Which part of each joint's bones each piece holds.

    Returns
    -------
    array, shape (pieces, j)
        1 for pieces without bones.
    """
    of_joint, of_piece = held.max(axis=0), held.max(axis=1, keepdims=True)
    home = np.divide(held, np.minimum(of_joint, of_piece), out=np.ones_like(held), where=held > 0)
    home[(held == 0) & (of_joint > 0)] = 0
    farther = 1 + FOREIGN * (1 - np.minimum(home, 1))
    farther[of_piece[:, 0] == 0] = 1
    return farther


def follow_lone_bones(
    held: NDArray[np.float64], piece: NDArray[np.int32], weights: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Let pieces with bones of one joint alone follow that joint: armour plates, blocks, wheels.

    Parameters
    ----------
    held : array, shape (pieces, j)
        Which part of each joint's bones each piece holds.
    piece : array, shape (k,)
        Of each place.
    weights : array, shape (k, j)

    Returns
    -------
    array, shape (k, j)
    """
    alone = (np.count_nonzero(held, axis=1) == 1)[piece]
    if not alone.any():
        return weights
    followed = weights.copy()
    followed[alone] = np.eye(held.shape[1])[held.argmax(axis=1)[piece[alone]]]
    return followed


def dress(
    graph: CutCellGraph,
    skin: Skin,
    held: NDArray[np.float64],
    weights: NDArray[np.float64],
) -> NDArray[np.float64]:
    """Let small pieces without bones follow what they sit on: eyes, buttons, horns, armour.

    Each moves as one, by the mean weights of its wearer where they touch.

    Parameters
    ----------
    graph : CutCellGraph
    skin : Skin
    held : array, shape (pieces, j)
        Which part of each joint's bones each piece holds.
    weights : array, shape (k, j)

    Returns
    -------
    array, shape (k, j)
    """
    points, piece, areas = skin.points, skin.piece, skin.areas
    # What has no area, such as a vertex without a face, touches nothing.
    has_area = np.bincount(piece, areas, len(held)) > 0
    worn = has_area & (held.max(axis=1) == 0) & (_longest_sides(points, piece) <= SMALL)
    if not worn.any():
        return weights
    wearer = ~worn[piece]
    # What is in patches all over is no body with things on it.
    if areas[wearer].sum() < areas.sum() / 2:
        return weights
    mine = np.flatnonzero(~wearer)
    away, corners = _nearest_skin(graph, wearer, points[mine])
    label = piece[mine]
    least = np.full(len(held), np.inf)
    np.minimum.at(least, label, away)
    touching = np.flatnonzero(away <= least[label] + CONTACT / graph.lattice.resolution)
    share = areas[mine[touching]] + 1e-12
    there = weights[corners[touching]].mean(axis=1)
    which = label[touching], np.arange(len(touching))
    gather = csr_array((share, which), (len(held), len(touching)))
    joints = np.eye(weights.shape[1])
    mean, leads = gather @ there, gather @ joints[there.argmax(axis=1)]
    whole = np.maximum(gather.sum(axis=1), 1e-300)[:, None]
    mean, leads = mean / whole, leads / whole
    likely = np.where(leads.max(axis=1, keepdims=True) > RIGID, leads, mean)
    alone = likely.max(axis=1) > RIGID
    mean[alone] = joints[likely[alone].argmax(axis=1)]
    dressed = weights.copy()
    dressed[mine] = mean[label]
    return dressed


def _longest_sides(points: NDArray[np.float64], piece: NDArray[np.int32]) -> NDArray[np.float64]:
    low = np.full((int(piece.max()) + 1, 3), np.inf)
    high = -low
    _bound(points, piece, low, high)
    return (high - low).max(axis=1)


@lean
def _bound(points, piece, low, high):
    for p in range(len(points)):
        for axis in range(3):
            low[piece[p], axis] = min(low[piece[p], axis], points[p, axis])
            high[piece[p], axis] = max(high[piece[p], axis], points[p, axis])


def _nearest_skin(
    graph: CutCellGraph, wearer: NDArray[np.bool_], points: NDArray[np.float64]
) -> tuple[NDArray[np.float64], NDArray[np.int32]]:
    """Measure from points to the wearers' skin: its vertices, and where rays cross it.

    Returns the distances, and for each point of the skin found the three places that its
    weights are the mean of.
    """
    first = graph.first_crossing
    chosen = np.zeros(len(graph.nodes), np.bool_)
    chosen[: len(wearer)] = wearer
    chosen[first:] = wearer[graph.faces[graph.triangle[first:], 0]]
    of, node = NodeGrid(graph.nodes, chosen, graph.lattice.resolution).nearest(points, TIE)
    node = node[np.searchsorted(of, np.arange(len(points)))]  # the first of equals
    away = np.linalg.norm(graph.nodes[node] - points, axis=1)
    on_face = graph.faces[graph.triangle[node]]
    return away, np.where(node[:, None] < first, node[:, None], on_face).astype(np.int32)
