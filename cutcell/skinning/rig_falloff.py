"""The falloff for rigs: weights that animate well, from geodesic distances (docs/falloff.md)."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ..geodesics import BoneDistances
from .diffusion import diffuse
from .laplacian import vertex_areas
from .pieces import bones_held, find_pieces
from .worn import dress, foreign_bones

POWER = 20
"""Skin belongs to its nearest joint; another that is 10 % farther counts a seventh."""
NEAREST_JOINTS = 8
"""Of each vertex, as some of the very nearest may turn out to be another piece's."""
LEAST_CELLS = 0.01
"""Lattice cells: distances that are all shorter are equal."""


def rig_kernel(
    distances: BoneDistances, allowed: NDArray[np.bool_] | None = None
) -> NDArray[np.float64]:
    """Turn distances into weights for animation.

    Parameters
    ----------
    distances : BoneDistances
        Best with bones fitted to the body, `leaf="fit"`.
    allowed : array, shape (n, j), bool, optional
        Which joints each vertex may follow.

    Returns
    -------
    array, shape (n, j)
        Rows sum to one.
    """
    graph, bones = distances.graph, distances.bones
    places, first = np.unique(graph.vertex_node, return_index=True)
    points, faces = graph.nodes[: len(places)], _whole(graph.faces)
    distance = np.maximum(distances.joint[:, first], LEAST_CELLS / graph.lattice.resolution)
    depth = distance.min(axis=0)

    piece = find_pieces(faces, len(places))
    held = _by_joint(bones_held(points, faces, piece, bones), bones.joint, len(distance))
    farther = foreign_bones(piece, held)
    if farther is not None:
        distance = distance * farther
    ratio = (distance.min(axis=0) / distance) ** POWER
    weights = (ratio / ratio.sum(axis=0)).T
    weights = diffuse(points, faces, weights, depth, graph.lattice.resolution)
    weights = dress(graph, vertex_areas(points, faces), piece, held, weights)
    return _permitted(weights[graph.vertex_node], distances.joint, allowed)


def _whole(faces: NDArray[np.int32]) -> NDArray[np.int32]:
    """Drop triangles that welding has closed up."""
    return faces[(faces != np.roll(faces, 1, axis=1)).all(axis=1)]


def _by_joint(
    held: NDArray[np.float64], joint: NDArray[np.int32], count: int
) -> NDArray[np.float64]:
    """Take each joint's best held bone: (pieces, b) to (pieces, j)."""
    result = np.zeros((len(held), count))
    for bone, owner in enumerate(joint):
        result[:, owner] = np.maximum(result[:, owner], held[:, bone])
    return result


def _permitted(
    weights: NDArray[np.float64],
    distance: NDArray[np.float64],
    allowed: NDArray[np.bool_] | None,
) -> NDArray[np.float64]:
    """Take away what a vertex may not follow; one left with nothing follows its nearest joint."""
    if allowed is None:
        return weights
    kept = np.where(allowed, weights, 0.0)
    lost = np.flatnonzero(kept.sum(axis=1) == 0)
    kept[lost, distance[:, lost].argmin(axis=0)] = 1
    return kept / kept.sum(axis=1, keepdims=True)
