"""The shortest path from a vertex back to a bone, traced through the bone's distance field."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..checks import check_integer
from ..errors import ParameterError
from ..graph import CutCellGraph
from .bones import Bones, distance_to_segment
from .distances import BoneDistances

STRAIGHT = 1.005
"""A path counts as straight if it is at most this factor longer than the straight line."""
SLACK = 0.9
"""The share of a straight segment's length by which the field must fall along it."""


def shortest_path(
    distances: BoneDistances, joint: int, vertex: int, field: ArrayLike | None = None
) -> NDArray[np.float64]:
    """Walk from a vertex back to the nearest of a joint's bones.

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
    array, shape (p, 3), float64
        From the vertex to a point of the bone, in the unit cube; no points if there is no path.
        With connectivity 6 and 26 it runs along the graph's edges, and its length is the value
        of the field; with "any" it is straightened, and its length is within a tenth of that.

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
        return np.empty((0, 3))
    own = distances.bones.joint == joint
    bones = Bones(distances.bones.start[own], distances.bones.end[own], distances.bones.joint[own])
    chain, foot = _descend(graph, field, bones, node)
    if graph.connectivity == "any":
        chain = _straightened(graph.nodes, field, chain)
    return np.concatenate([graph.nodes[chain], foot[None]])


def path_length(path: ArrayLike) -> float:
    """Return the length of a path of points (p, 3)."""
    return float(np.linalg.norm(np.diff(np.asarray(path, float), axis=0), axis=1).sum())


def _descend(
    graph: CutCellGraph, field: NDArray[np.float64], bones: Bones, node: int
) -> tuple[list[int], NDArray[np.float64]]:
    """Descend the field from neighbour to neighbour, until the bone is straight ahead."""
    indptr, indices, lengths = graph.adjacency
    chain = [node]
    while True:
        here = chain[-1]
        straight, foot = _to_bone(graph.nodes[here], bones)
        if field[here] <= straight * STRAIGHT + 1e-12:
            return chain, foot
        around = slice(indptr[here], indptr[here + 1])
        near = indices[around]
        # Edges may have zero length, and an any-angle field may have local minima.
        total = np.where(np.isin(near, chain), np.inf, field[near] + lengths[around])
        if not np.isfinite(total).any():
            return chain, foot
        chain.append(int(near[np.argmin(total)]))


def _to_bone(point: NDArray[np.float64], bones: Bones) -> tuple[float, NDArray[np.float64]]:
    """Return the distance to the nearest bone, and the nearest point on it."""
    distance = distance_to_segment(point, bones.start, bones.end)
    k = int(np.argmin(distance))
    start, along = bones.start[k], bones.end[k] - bones.start[k]
    squared = float(along @ along)
    fraction = np.clip((point - start) @ along / squared, 0, 1) if squared > 0 else 0.0
    return float(distance[k]), start + fraction * along


def _straightened(
    nodes: NDArray[np.float64], field: NDArray[np.float64], chain: list[int]
) -> list[int]:
    """Leave out nodes between two with line of sight, so that the path is shortest.

    Along a straight segment of a shortest path the field falls by the segment's length; where it
    falls by more, the straight line leaves the body.
    """
    points, height = nodes[chain], field[chain]
    last = len(chain) - 1
    left, following = np.zeros(len(chain)), np.zeros(len(chain), int)
    for k in range(last - 1, -1, -1):
        length = np.linalg.norm(points[k + 1 :] - points[k], axis=1)
        fall = height[k] - height[k + 1 :]
        seen = (fall <= length * STRAIGHT) & (fall >= SLACK * length)
        seen[0] = True
        total = np.where(seen, length + left[k + 1 :], np.inf)
        best = int(np.flatnonzero(total <= total.min() * (1 + 1e-9))[-1])  # the fewest points
        left[k], following[k] = total[best], k + 1 + best
    kept = [0]
    while kept[-1] < last:
        kept.append(int(following[kept[-1]]))
    return [chain[k] for k in kept]
