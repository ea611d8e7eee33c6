"""The falloff for rigs: weights that animate well, from geodesic distances (docs/falloff.md)."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.distance import cdist

from ..compiled import lean
from ..geodesics import BoneDistances, Bones
from ..progress import Tell, share_of
from ..threads import together
from .diffusion import Diffusion
from .pieces import bones_held
from .skin import Skin
from .worn import dress, follow_lone_bones, foreign_bones

POWER = 20
"""Skin belongs to its nearest joint; another that is 10 % farther counts a seventh."""
NEAREST_JOINTS = 3
"""Of each vertex, at least. As many others are measured, and hardly a vertex has a fourth that is
not among them. It follows more joints only as the skin around it does, however many are kept."""
TOWARDS = 1 / 6
"""Nearness of a bone to skin that looks right at it, as part of what it is to skin that looks
away: skin covers the bones that it looks away from."""
LEAST_CELLS = 0.01
"""Lattice cells: distances that are all shorter are equal."""
COVER = 1.5
"""Skin that is so many times as far from a bone as its median skin is not about that bone. The
edges of a square bar are 1.41 times as far as the middle of its sides."""
LEAST_COVER = 0.5
"""Lattice cells: no bone's skin is nearer than this."""
LEADS_ON = 0.02
"""Of the longest side: as near to another joint's bone must a bone end to lead on to it."""
SHARES = 1e-3
"""Smaller shares do not count as a joint's skin."""
TAIL = 0.05
"""Of a vertex' largest weight: taken off all its weights, so that what is far gets nothing."""


def rig_kernel(
    distances: BoneDistances, skin: Skin, tell: Tell = lambda done: None
) -> NDArray[np.float64]:
    """Turn distances into weights for animation.

    Parameters
    ----------
    distances : BoneDistances
        Best with bones fitted to the body, `leaf="fit"`.
    skin : Skin
        Of their graph.
    tell : callable
        See `progress.Tell`.

    Returns
    -------
    array, shape (k, j)
        For the places of the mesh. Rows sum to one.
    """
    graph, bones = distances.graph, distances.bones
    distance, resolution = distances.at_places, graph.lattice.resolution
    weights = np.zeros(distance.shape[::-1])

    def divide() -> NDArray[np.float64]:
        held = _held_by_joint(skin, bones, len(distance))
        first_bone = np.searchsorted(bones.joint, np.arange(len(distance) + 1))
        known = skin.points, skin.normals, distance, foreign_bones(held), skin.piece
        ends = first_bone, bones.start, bones.end, LEAST_CELLS / resolution
        anywhere, chosen = np.full(len(distance), np.inf), np.ones(len(weights), np.bool_)
        _put_shares(*known, *ends, anywhere, chosen, weights)
        cover = _cover(weights, distance, skin.areas, bones, resolution)
        _mark_beyond(distance, weights, cover, chosen)
        _put_shares(*known, *ends, cover, chosen, weights)
        return held

    def prepare() -> Diffusion:
        return Diffusion.over(skin, distance.min(axis=0), resolution, share_of(tell, 0, 0.5))

    held, diffusion = together(divide, prepare)
    weights = diffusion.spread(weights, share_of(tell, 0.5, 1))
    if len(held) > 1:
        weights = follow_lone_bones(held, skin.piece, weights)
    weights = dress(graph, skin, held, weights)
    _end(weights)
    return weights


@lean
def _put_shares(
    points, normals, distance, foreign, piece, bone, start, end, near, cover, chosen, weights
):
    """Divide chosen places among joints by distance; `bone` tells where each joint's bones begin.

    Distances up to `near` are equal; beyond a joint's `cover` they grow by their square.
    """
    for v in range(len(points)):
        if not chosen[v]:
            continue
        least = np.inf
        for j in range(len(distance)):
            weights[v, j] = 0.0
            if distance[j, v] == np.inf:
                continue
            away = foreign[piece[v], j] * max(distance[j, v], near)
            away *= max(1.0, distance[j, v] / cover[j])
            away /= _facing(points[v], normals[v], start, end, bone[j], bone[j + 1])
            weights[v, j] = away
            least = min(least, away)
        total = 0.0
        for j in range(len(distance)):
            if distance[j, v] < np.inf:
                weights[v, j] = (least / weights[v, j]) ** POWER
                total += weights[v, j]
        for j in range(len(distance)):
            weights[v, j] /= total


@lean
def _mark_beyond(distance, weights, cover, found):
    """Mark the places, shape (k,), that have a share of a joint that does not cover them."""
    for v in range(len(weights)):
        found[v] = False
        for j in range(len(distance)):
            if weights[v, j] > SHARES and distance[j, v] > cover[j]:
                found[v] = True


@lean
def _end(weights):
    """Take a part of each place's largest weight off all of them, down to zero, in place."""
    for v in range(len(weights)):
        largest = 0.0
        for j in range(weights.shape[1]):
            largest = max(largest, weights[v, j])
        total = 0.0
        for j in range(weights.shape[1]):
            weights[v, j] = max(weights[v, j] - TAIL * largest, 0.0)
            total += weights[v, j]
        for j in range(weights.shape[1]):
            weights[v, j] /= total


@lean
def _facing(point, normal, start, end, first, last):
    """Return how much skin looks away from the nearest of some bones, `TOWARDS` to 1."""
    nearest, cosine = np.inf, 0.0
    for b in range(first, last):
        along, squared = 0.0, 0.0
        for c in range(3):
            along += (point[c] - start[b, c]) * (end[b, c] - start[b, c])
            squared += (end[b, c] - start[b, c]) ** 2
        t = min(max(along / squared, 0.0), 1.0) if squared > 0 else 0.0
        length, out = 0.0, 0.0
        for c in range(3):
            way = point[c] - start[b, c] - t * (end[b, c] - start[b, c])
            length += way * way
            out += way * normal[c]
        if length < nearest:
            nearest = length
            cosine = out / np.sqrt(length) if length > 0 else 0.0
    return TOWARDS + (1 - TOWARDS) * (1 + cosine) / 2


def _cover(
    weights: NDArray[np.float64],
    distance: NDArray[np.float64],
    areas: NDArray[np.float64],
    bones: Bones,
    resolution: int,
) -> NDArray[np.float64]:
    """Measure up to which distance skin is about each joint's bones, shape (j,).

    A neck's skin lies all around it at about one distance: what is much farther, such as a
    chin, is not the neck's even if no other bone is nearer. Where a last bone ends is only a
    guess: its skin may be at any distance, which is infinite here.
    """
    place, joint = np.nonzero(weights > SHARES)
    away, part = distance[joint, place], weights[place, joint] * (areas[place] + 1e-12)
    order = np.lexsort((away, joint))
    joint, away, total = joint[order], away[order], np.cumsum(part[order])
    first = np.searchsorted(joint, np.arange(len(distance) + 1))
    before = np.concatenate([[0.0], total])[first]
    middle = np.searchsorted(total, (before[:-1] + before[1:]) / 2)
    cover = np.full(len(distance), np.inf)
    known = _leads_on(bones, len(distance)) & (first[1:] > first[:-1])
    cover[known] = COVER * np.maximum(away[middle[known]], LEAST_COVER / resolution)
    return cover


def _leads_on(bones: Bones, joints: int) -> NDArray[np.bool_]:
    """Tell which joints have a bone that ends where another joint's begins."""
    meets = cdist(bones.end, bones.start, "chebyshev") < LEADS_ON
    meets &= bones.joint[:, None] != bones.joint
    leads = np.zeros(joints, np.bool_)
    leads[bones.joint[meets.any(axis=1)]] = True
    return leads


def _held_by_joint(skin: Skin, bones: Bones, joints: int) -> NDArray[np.float64]:
    """Measure which part of each joint's best held bone is in each piece, shape (pieces, j)."""
    if not skin.piece.any():  # a lone piece: no bone belongs more to another
        return np.ones((1, joints))
    held = bones_held(skin.points, skin.faces, skin.piece, bones)
    result = np.zeros((len(held), joints))
    for bone, owner in enumerate(bones.joint):
        result[:, owner] = np.maximum(result[:, owner], held[:, bone])
    return result


def permitted(
    weights: NDArray[np.float64], distance: NDArray[np.float64], allowed: NDArray[np.bool_]
) -> NDArray[np.float64]:
    """Take away what a vertex may not follow; one left with nothing follows its nearest joint.

    Parameters
    ----------
    weights : array, shape (n, j)
    distance : array, shape (j, n)
    allowed : array, shape (n, j)

    Returns
    -------
    array, shape (n, j)
        Rows sum to one.
    """
    kept = np.where(allowed, weights, 0.0)
    lost = np.flatnonzero(kept.sum(axis=1) == 0)
    kept[lost, distance[:, lost].argmin(axis=0)] = 1
    return kept / kept.sum(axis=1, keepdims=True)
