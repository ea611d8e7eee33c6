"""Predicted weights in the reference's order of vertices and joints."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from cutcell.errors import SkeletonError, WeightsError
from cutcell.rig import Rig, Skeleton
from cutcell.runtime.display import listed

NEAR = 1e-3
"""Tolerance of positions, in longest sides: those stored in 16 bits agree within it."""


class _Placed:
    """A rig in the scene's axes, in the unit cube, so that units and origins do not matter.

    Shapes: vertices (n, 3), joints (j, 3), used (k,).
    """

    def __init__(self, rig: Rig) -> None:
        turn, shift = rig.world[:3, :3].T, rig.world[:3, 3]
        vertices, joints = rig.mesh.vertices @ turn + shift, rig.skeleton.joints @ turn + shift
        self.mesh, self.used = rig.mesh.welded, rig.mesh.used
        low, high = vertices[self.used].min(axis=0), vertices[self.used].max(axis=0)
        side = (high - low).max()
        self.vertices, self.joints = (vertices - low) / side, (joints - low) / side


def align_weights(predicted: Rig, reference: Rig) -> tuple[NDArray[np.float64], list[str]]:
    """Return a rig's weights for the vertices and joints of another, and what was matched how.

    Vertices match in order, or else by position. Joints match by name, or else by position. Joints
    of the reference that the prediction lacks get no weight.

    Raises
    ------
    WeightsError
        The prediction has no weights, or vertices of one lie on none of the other.
    SkeletonError
        A joint of the prediction carries weight and matches no joint of the reference.
    """
    if predicted.weights is None:
        raise WeightsError("has no weights to evaluate")
    source, target = _Placed(predicted), _Placed(reference)
    weights, notes = predicted.weights, []
    if not _same_order(source, target):
        weights = _at_vertices(weights, source, target)
        counts = f"{len(source.vertices):,} to {len(target.vertices):,}"
        notes.append(f"vertices matched by position ({counts})")
    if predicted.skeleton.names == reference.skeleton.names:
        return weights, notes
    carrying = np.flatnonzero(predicted.weights.any(axis=0))
    columns = _by_name(predicted.skeleton, reference.skeleton)
    if not np.isin(carrying, columns).all():
        columns = _by_position(source, target, carrying, reference.skeleton.deform)
        if (lost := np.setdiff1d(carrying, columns)).size:
            raise SkeletonError(
                f"{lost.size} of its joints carry weight and match no joint of the reference by "
                f"name or position: {listed([predicted.skeleton.names[k] for k in lost])}. Predict "
                "weights for the skeleton of the reference, or give the joints its names"
            )
        notes.append("joints matched by position, because their names differ")
    lacking = columns < 0
    if reference.weights is not None:
        lacking &= reference.weights.any(axis=0)
    if lacking.any():
        absent = listed([reference.skeleton.names[k] for k in np.flatnonzero(lacking)])
        notes.append(f"it lacks joints that have weight in the reference: {absent}")
    return np.where(columns >= 0, weights[:, columns], 0.0), notes


def _same_order(source: _Placed, target: _Placed) -> bool:
    if len(source.vertices) != len(target.vertices):
        return False
    return bool((np.abs(source.vertices - target.vertices) <= NEAR)[target.used].all())


def _at_vertices(
    weights: NDArray[np.float64], source: _Placed, target: _Placed
) -> NDArray[np.float64]:
    """Return the weights (n, j) of the source at the vertices of the target."""
    welded, group = np.unique(source.mesh.index[source.used], return_inverse=True)
    points = source.vertices[source.mesh.first[welded]]
    # Split vertices at one position may differ: their mean does not depend on their order.
    mean = np.zeros((len(points), weights.shape[1]))
    np.add.at(mean, group, weights[source.used])
    mean /= np.bincount(group)[:, None]
    places = target.vertices[target.used]
    distance, nearest = cKDTree(points).query(places)
    back, _ = cKDTree(places).query(points)
    for far, whose in ((distance > NEAR, "the reference"), (back > NEAR, "the prediction")):
        if far.any():
            raise WeightsError(
                f"has {len(source.vertices):,} vertices, the reference has "
                f"{len(target.vertices):,}, and {far.sum():,} of {far.size:,} of {whose} lie on "
                "none of the other. Predict weights for the mesh of the reference, in its pose and "
                "with the same axis up"
            )
    result = np.zeros((len(target.vertices), weights.shape[1]))
    result[target.used] = mean[nearest]
    sums = result.sum(axis=1, keepdims=True)
    return np.divide(result, sums, out=np.zeros_like(result), where=sums > 0)


def _by_name(predicted: Skeleton, reference: Skeleton) -> NDArray[np.intp]:
    """Return the predicted joint of each reference joint, -1 for none; names twice match none."""
    number = {
        name: joint
        for joint, name in enumerate(predicted.names)
        if predicted.names.count(name) == reference.names.count(name) == 1
    }
    return np.array([number.get(name, -1) for name in reference.names], np.intp)


def _by_position(
    source: _Placed, target: _Placed, carrying: NDArray[np.intp], deform: NDArray[np.bool_]
) -> NDArray[np.intp]:
    """Return the source's joint at each joint of the target, one to one, -1 for none.

    If several joints of the target share a position, the one that deforms matches, if it is unique.
    """
    columns = np.full(len(target.joints), -1, np.intp)
    tree = cKDTree(target.joints)
    for joint in carrying:
        hits = np.array(tree.query_ball_point(source.joints[joint], NEAR), np.intp)
        if len(hits) > 1:
            hits = hits[deform[hits]]
        if len(hits) == 1 and columns[hits[0]] < 0:
            columns[hits[0]] = joint
    return columns
