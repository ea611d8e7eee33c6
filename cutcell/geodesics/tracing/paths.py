"""The shortest path from a vertex back to a bone, traced through the bone's distance field."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.sparse.csgraph import dijkstra

from ...bones.bones import Bones
from ...checks import check_integer
from ...errors import ParameterError
from ...geometry.segments import closest_on_segment, distance_to_segment
from ...graph import INTERIOR, MESH, SURFACE, CutCellGraph
from ..distances import BoneDistances
from .inside import Inside
from .taut import taut

PIECES = ("mesh edge", "interior edge", "surface edge", "line of sight", "outside")
"""Kinds of the pieces of a path. The first three are edges of the graph, numbered as its kinds of
edges; a line of sight cuts across the body. Outside lies what leaves the body to reach a bone that
is not in it, and that alone."""
LINE_OF_SIGHT, OUTSIDE_PIECE = 3, 4
SAME_LENGTH = 1e-12
"""Lengths that differ by less than this, in the unit cube, are equal."""


@dataclass(frozen=True, eq=False)
class TracedPath:
    """A path from a vertex to a bone, in pieces.

    Parameters
    ----------
    points : array, shape (p, 3), float64
        From the vertex to a point of the bone, in the unit cube; none if there is no path.
    kinds : array, shape (p - 1,), uint8
        What each piece between two points is, an index into `PIECES`.
    """

    points: NDArray[np.float64]
    kinds: NDArray[np.uint8]

    @property
    def lengths(self) -> NDArray[np.float64]:
        """The length of each piece, shape (p - 1,)."""
        length: NDArray[np.float64] = np.linalg.norm(np.diff(self.points, axis=0), axis=1)
        return length

    @property
    def length(self) -> float:
        """The length of the whole path."""
        return float(self.lengths.sum())


def trace_path(
    distances: BoneDistances, joint: int, vertex: int, field: ArrayLike | None = None
) -> TracedPath:
    """Walk from a vertex back to the nearest of a joint's bones, and classify its pieces.

    No piece is farther than about half a lattice cell from the body (`inside.TOLERANCE`), except
    those of the kind "outside": the way from the node nearest to a bone to that bone, where the
    bone is not in the body.

    Parameters
    ----------
    distances : BoneDistances
    joint : int
    vertex : int
        Of the mesh as given.
    field : array_like, shape (N,), optional
        What `distances.field(joint)` returns; computed when left out.

    Returns
    -------
    TracedPath
        With connectivity 6 and 26 it runs along the graph's edges, and its length is the value
        of the field; with "any" it is straightened, and some per cent longer (docs/performance.md).

    Raises
    ------
    ParameterError
        There is no such vertex, `joint` may carry no weight, or `field` has another shape.
    """
    graph = distances.graph
    vertex = check_integer("vertex", vertex, 0, len(graph.vertex_node) - 1)
    field = np.asarray(distances.field(joint) if field is None else field, np.float64)
    if field.shape != (len(graph.nodes),):
        raise ParameterError(
            f"field has the shape {field.shape}, expected one value for each of the graph's "
            f"{len(graph.nodes)} nodes"
        )
    node = int(graph.vertex_node[vertex])
    if not np.isfinite(field[node]):
        return TracedPath(np.empty((0, 3)), np.empty(0, np.uint8))
    of_joint = distances.bones.joint == joint
    bones, sources = distances.bones.subset(of_joint), distances.sources.subset(of_joint)
    source = np.full(len(graph.nodes), np.inf)
    np.minimum.at(source, sources.node, sources.distance)
    chain, inside = _descend(graph, field, source, node), distances.inside
    feet = _nearest_on(bones, graph.nodes[chain])
    at_source = field[chain[-1]] >= source[chain[-1]] - SAME_LENGTH
    if not at_source and not inside.segments(graph.nodes[chain[-1:]], feet[-1:])[0].all():
        chain = _search(graph, source, node)
        feet = _nearest_on(bones, graph.nodes[chain])
    bends = list(range(len(chain)))
    if graph.connectivity == "any":
        bends = taut(inside, graph.nodes[chain], field[chain], feet)
    path, kinds = _pieces(graph, [chain[k] for k in bends], np.diff(bends) > 1)
    last, to_bone = _to_bone(inside, path[-1], feet[bends[-1]])
    return TracedPath(np.concatenate([path, last]), np.concatenate([kinds, to_bone]))


def path_length(path: ArrayLike) -> float:
    """Return the length of a path of points (p, 3)."""
    return float(np.linalg.norm(np.diff(np.asarray(path, float), axis=0), axis=1).sum())


def _descend(
    graph: CutCellGraph, field: NDArray[np.float64], source: NDArray[np.float64], node: int
) -> list[int]:
    """Descend the field from neighbour to neighbour, to a source or a local minimum.

    Along edges the field is exact, and a neighbour is next on the shortest path if the edge to it
    is as long as the field falls. At any angle the neighbour in the direction of the steepest
    descent is, and the field may have local minima.
    """
    indptr, indices, lengths = graph.adjacency
    chain = [node]
    while field[chain[-1]] < source[chain[-1]] - SAME_LENGTH:
        current = chain[-1]
        around = slice(indptr[current], indptr[current + 1])
        near, length = indices[around], lengths[around]
        if graph.connectivity == "any":
            falls = field[near] < field[current]
            with np.errstate(divide="ignore", invalid="ignore"):
                cost = np.where(falls, (field[near] - field[current]) / length, np.inf)
        else:  # edges may have zero length
            cost = np.where(np.isin(near, chain), np.inf, field[near] + length)
        if not len(near) or cost.min() == np.inf:
            break
        chain.append(int(near[np.argmin(cost)]))
    return chain


def _search(graph: CutCellGraph, source: NDArray[np.float64], node: int) -> list[int]:
    """Find the shortest path along edges from a node to a source."""
    length, before = dijkstra(graph.csr(), indices=node, return_predecessors=True)
    chain = [int(np.argmin(length + source))]
    while chain[-1] != node:
        chain.append(int(before[chain[-1]]))
    return chain[::-1]


def _nearest_on(bones: Bones, points: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the point nearest to each of some points on any bone, shape (p, 3)."""
    distance = distance_to_segment(points[:, None], bones.start, bones.end)
    nearest = distance.argmin(axis=1)
    return closest_on_segment(points, bones.start[nearest], bones.end[nearest])[0]


def _pieces(
    graph: CutCellGraph, chain: list[int], sees: NDArray[np.bool_]
) -> tuple[NDArray[np.float64], NDArray[np.uint8]]:
    """Return the points of a chain of nodes, and the kinds of the pieces between them."""
    kind = graph.node_kind[chain]
    first, second = np.minimum(kind[:-1], kind[1:]), np.maximum(kind[:-1], kind[1:])
    # Mesh vertices are joined to each other and to surface nodes, all else lies inside.
    edge = np.where(first != MESH, INTERIOR, np.where(second == MESH, MESH, SURFACE))
    return graph.nodes[chain], np.where(sees, LINE_OF_SIGHT, edge).astype(np.uint8)


def _to_bone(
    inside: Inside, start: NDArray[np.float64], foot: NDArray[np.float64]
) -> tuple[NDArray[np.float64], NDArray[np.uint8]]:
    """Divide the last piece where it leaves the body: its points but the first, and its kinds."""
    (is_in,) = inside.segments(start[None], foot[None])
    change = np.flatnonzero(np.diff(is_in)) + 1
    share = np.append(change, len(is_in)) / len(is_in)
    kinds = np.where(is_in[np.append(0, change)], LINE_OF_SIGHT, OUTSIDE_PIECE)
    return start + share[:, None] * (foot - start), kinds.astype(np.uint8)
