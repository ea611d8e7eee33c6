"""Edges that stretch or shrink as joints turn: bad weights, seen without others to compare."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array

from ..geometry.vectors import TIE
from ..graph import MESH, CutCellGraph
from ..rig import Skeleton
from .kinematics import axis_rotation

STRETCH_DEGREES = 30.0
"""Each joint turns by this about x, y and z, as for the deformation error."""
FACTOR = 2.0
"""An edge that becomes more than this many times as long or short is stretched."""
MAX_SHARE = 0.05
"""Share of the surface above which weights are suspicious: a few of artists' have more."""
MAX_EDGES = 6000
"""Edges to measure; of more, a sample by length."""
BLOCK_NUMBERS = 1 << 20
"""Numbers of each array of a block of edges: 8 MB."""


@dataclass(frozen=True, eq=False)
class Stretch:
    """How much of a surface stretches as its joints turn one by one.

    Parameters
    ----------
    share : float
        Part of the surface's edge length that becomes more than twice as long or short as some
        joint turns by 30 degrees about x, y or z.
    joint : int or None
        The joint whose turns stretch the most edge length; None if nothing stretches.
    axis : {"x", "y", "z"}
        The axis of its turn that changes the length of an edge most.
    vertex : int or None
        An end of that edge, in the file.
    position : tuple of 3 floats or None
        The middle of that edge, in the file's units.
    vertices : array of int
        The ends of all stretched edges, in the file; ascending. Of a large mesh, those of a sample.
    """

    share: float
    joint: int | None = None
    axis: str = "x"
    vertex: int | None = None
    position: tuple[float, float, float] | None = None
    vertices: NDArray[np.intp] = field(default_factory=lambda: np.zeros(0, np.intp))


class TurnedEdges(NamedTuple):
    """Edges whose length may change much as a joint turns, each with that joint.

    Parameters
    ----------
    edge, joint : arrays, shape (c,)
    before : array, shape (c, 1)
        Length at rest.
    after : array, shape (c, t)
        Length in each pose.
    """

    edge: NDArray[np.intp]
    joint: NDArray[np.intp]
    before: NDArray[np.float64]
    after: NDArray[np.float64]

    def subset(self, which: NDArray[np.bool_]) -> TurnedEdges:
        """Return those for which `which`, shape (c,), is true."""
        edge, joint, before, after = self
        return TurnedEdges(edge[which], joint[which], before[which], after[which])


def measure_stretch(
    graph: CutCellGraph, skeleton: Skeleton, weights: NDArray[np.float64] | csr_array
) -> Stretch:
    """Turn each joint that moves a part of a surface, and measure how much of it stretches.

    Parameters
    ----------
    graph : CutCellGraph
        Of the mesh.
    skeleton : Skeleton
        In the file's units.
    weights : array or csr_array, shape (n, j), float64
        Rows sum to one. Edges at vertices whose row is all zero are left out.

    Returns
    -------
    Stretch
    """
    is_mesh = graph.edge_kind == MESH
    edges, amount = _sampled(graph.edges[is_mesh], graph.lengths[is_mesh])
    nodes, local = _renumbered(edges, graph.first_point)
    vertex = np.empty(graph.first_point, np.intp)
    vertex[graph.vertex_node[::-1]] = np.arange(len(graph.vertex_node))[::-1]  # the first of each
    shares = csr_array(weights[vertex[nodes]]).toarray()
    # Vertices without weight are another finding.
    is_weighted = np.asarray(shares.any(axis=1))[local].all(axis=1)
    edges, local, amount = edges[is_weighted], local[is_weighted], amount[is_weighted]
    follows = followed(shares, skeleton)
    joints = graph.lattice.to_unit(skeleton.joints)
    turned = np.flatnonzero(np.ptp(follows, axis=1) > TIE)  # else all moves as one
    turns = [axis_rotation(axis, STRETCH_DEGREES) for axis in "xyz"]
    blocks = [
        block.subset(_is_stretched(block))
        for block in turned_edges(graph.nodes[nodes], local, follows, joints, turned, turns, FACTOR)
    ]
    edge, joint, before, after = (np.concatenate(parts) for parts in zip(*blocks, strict=True))
    if not len(edge):
        return Stretch(0.0)
    stretched = np.unique(edge)
    worst = int(np.bincount(joint, amount[edge]).argmax())
    change = np.where((joint == worst)[:, None], np.abs(after - before), -1.0)
    row, axis = divmod(int(change.argmax()), len(turns))
    ends, part = edges[edge[row]], float(amount[stretched].sum() / amount.sum())
    x, y, z = graph.lattice.to_file(graph.nodes[ends].mean(axis=0)).tolist()
    place, vertices = (x, y, z), np.unique(vertex[edges[stretched]])
    return Stretch(part, worst, "xyz"[axis], int(vertex[ends[0]]), place, vertices)


def _is_stretched(turned: TurnedEdges) -> NDArray[np.bool_]:
    bound = FACTOR * (1 + TIE)
    longer, shorter = turned.after > bound * turned.before, bound * turned.after < turned.before
    return np.asarray((longer | shorter).any(axis=1))


def _sampled(
    edges: NDArray[np.int32], lengths: NDArray[np.float64]
) -> tuple[NDArray[np.int32], NDArray[np.float64]]:
    """Return edges at even steps along all edges end to end, and how much each of them counts.

    Welded vertices, and with them the edges, are in an order of space, whatever the file's is.
    """
    if len(edges) <= MAX_EDGES:
        return edges, lengths
    total = np.cumsum(lengths)
    steps = (np.arange(MAX_EDGES) + 0.5) / MAX_EDGES * total[-1]
    times = np.bincount(np.searchsorted(total, steps), minlength=len(edges))
    chosen = np.flatnonzero(times)
    return edges[chosen], times[chosen].astype(np.float64)


def _renumbered(
    edges: NDArray[np.int32], count: int
) -> tuple[NDArray[np.intp], NDArray[np.integer]]:
    """Return the nodes of some edges, and the edges between these alone."""
    is_end = np.zeros(count, np.bool_)
    is_end[edges] = True
    return np.flatnonzero(is_end), (np.cumsum(is_end) - 1)[edges]


def followed(weights: NDArray[np.float64], skeleton: Skeleton) -> NDArray[np.float64]:
    """Return by how much points follow each joint: its weight and that of all below, (j, n).

    Shapes: weights (n, j).
    """
    follows = np.array(weights.T, order="C")
    for joint in np.argsort(-skeleton.depth, kind="stable"):
        if skeleton.parents[joint] >= 0:
            follows[skeleton.parents[joint]] += follows[joint]
    return follows


def turned_edges(
    points: NDArray[np.float64],
    edges: NDArray[np.integer],
    follows: NDArray[np.float64],
    joints: NDArray[np.float64],
    turned: NDArray[np.integer],
    turns: Sequence[NDArray[np.float64]],
    factor: float,
) -> Iterator[TurnedEdges]:
    """Turn joints one by one and measure all edges that may stretch or shrink by a factor.

    Joint q moves a point p by S (R - I)(p - q) if the point follows it by S. An edge between
    points that follow alike shrinks at most by the cosine of half the angle. The rest of its
    change is at most the difference of S times the chord at its middle. Few edges and joints
    have as much as the factor needs.

    Shapes: points (p, 3), edges (e, 2), follows (j, p), joints (j, 3), turned (c,), turns (3, 3).
    """
    cosine = min((np.trace(turn) - 1) / 2 for turn in turns)
    chord, half = np.sqrt(2 - 2 * cosine), np.sqrt((1 + cosine) / 2)
    needed = min(factor - 1, half - 1 / factor) / chord * (1 - TIE)
    corners = np.vstack([points, joints[turned]])
    longest = np.linalg.norm(np.ptp(corners, axis=0))
    rows, step = follows[turned], max(1, BLOCK_NUMBERS // max(len(turned), 1))
    for first in range(0, max(len(edges), 1), step):
        start, end = edges[first : first + step].T
        along = points[start] - points[end]
        before = _lengths(along)
        difference = rows.take(start, axis=1)
        difference -= rows.take(end, axis=1)
        np.abs(difference, out=difference)
        likely = np.flatnonzero(difference > needed / longest * before)
        row, edge = np.divmod(likely, max(len(start), 1))
        middle = (points[start[edge]] + points[end[edge]]) / 2
        lever = _lengths(middle - joints[turned[row]])
        is_much = difference[row, edge] * lever > needed * before[edge]
        row, edge = row[is_much], edge[is_much]
        joint = turned[row]
        start, end = start[edge], end[edge]
        moved = follows[joint, start, None] * (points[start] - joints[joint])
        moved -= follows[joint, end, None] * (points[end] - joints[joint])
        posed = [along[edge] + moved @ (turn - np.eye(3)).T for turn in turns]
        after = np.stack([_lengths(one) for one in posed], axis=1)
        yield TurnedEdges(edge + first, joint, before[edge, None], after)


def _lengths(vectors: NDArray[np.float64]) -> NDArray[np.float64]:
    return np.sqrt(np.einsum("ij,ij->i", vectors, vectors))
