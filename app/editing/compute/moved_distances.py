"""Distances while joints are being moved: only those of changed bones are measured."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array

from cutcell.animation.any_angle.theta_star import ON_BONE
from cutcell.bones.bones import Bones
from cutcell.geodesics.distances import BoneDistances, bone_distances
from cutcell.geodesics.fallback import REACHED
from cutcell.graph.fingerprint import APPROXIMATE
from cutcell.method import Method
from cutcell.rig import Skeleton
from cutcell.rig.rows import (
    chosen_entries,
    least,
    lookup,
    rows_of_entries,
    with_columns,
)


class MovedDistances:
    """Measures the distances of joints whose bones have moved; the others keep theirs.

    The fingerprint of results is `APPROXIMATE`, so that they are not taken for exact ones.
    With connectivity 6 and 26 the results equal `bone_distances`, except that leaf bones are
    translated instead of fitted again, and vertices that no path reaches keep their distances.
    With any angle, paths end where the distance of the nearest joint was `within` times smaller:
    a vertex that loses a joint keeps its others, even where a nearer one exists now, and a joint
    that it gains must be nearer than one that it had.

    Parameters
    ----------
    distances : BoneDistances
        Before anything moved; not of vertices that may follow different joints at one place.
    method : Method
        The method of `distances`.
    within : float
        As of `bone_distances`.
    """

    def __init__(self, distances: BoneDistances, method: Method, within: float) -> None:
        self._distances, self._method, self._within = distances, method, within
        self._nearest_distance = distances.solver.nearest_distance(
            distances.bones, distances.sources
        )
        rows = distances.rows
        self._farthest, self._reached = np.zeros(rows.shape[0]), np.zeros(rows.shape[0], np.bool_)
        np.maximum.at(self._farthest, rows_of_entries(rows), rows.data)
        self._reached[distances.graph.vertex_node] = distances.fallback == REACHED

    def measure(self, skeleton: Skeleton) -> BoneDistances:
        """Return the distances of a moved skeleton, in which the same joints deform."""
        distances, method = self._distances, self._method
        bones = _carried(distances, skeleton, method)
        if bones is None:  # some continue others now that did not
            return bone_distances(
                distances.solver,
                skeleton,
                method=method,
                nearest_joints=distances.nearest_joints,
                within=self._within,
            )
        old = distances.bones
        changed = ((bones.start != old.start) | (bones.end != old.end)).any(axis=1)
        joints = np.unique(bones.joint[changed])
        if not len(joints):
            return distances
        is_moved = np.isin(bones.joint, joints)
        moved = bones.subset(is_moved)
        sources = distances.solver.sources(moved, method.samples)
        nearest = distances.nearest_joints and min(distances.nearest_joints, len(joints))
        fresh = distances.solver.paths(
            moved, sources, nearest, self._within, self._nearest_distance
        )
        return replace(
            distances,
            rows=self._merged(joints, with_columns(fresh, joints, distances.rows.shape[1])),
            bones=bones,
            sources=distances.sources.replaced(is_moved, sources),
            skeleton=skeleton,
        ).identified(APPROXIMATE)

    def _merged(self, joints: NDArray[np.intp], fresh: csr_array) -> csr_array:
        """Return the distances of all joints, with those of some joints replaced."""
        before, reached = self._distances.rows, self._reached
        row, of_fresh = rows_of_entries(before), rows_of_entries(fresh)
        stays = ~np.isin(before.indices, joints) | ~reached[row]
        is_valid = reached[of_fresh]
        if self._distances.nearest_joints is not None:
            is_new = np.isinf(lookup(before, of_fresh, fresh.indices))
            is_valid &= ~is_new | (fresh.data <= self._farthest[of_fresh])
        nearest = np.minimum(
            least(chosen_entries(before, stays)), least(chosen_entries(fresh, is_valid))
        )
        stays |= np.isinf(nearest)[row]  # else nothing would be left
        if self._distances.nearest_joints is not None:
            nearest = np.maximum(nearest, ON_BONE / self._distances.graph.lattice.resolution)
            is_valid &= fresh.data <= (self._within * nearest)[of_fresh]
        data, indices, rows = (
            np.concatenate([old[stays], new[is_valid]])
            for old, new in (
                (before.data, fresh.data),
                (before.indices, fresh.indices),
                (row, of_fresh),
            )
        )
        order = np.lexsort((indices, rows))
        start = np.searchsorted(rows[order], np.arange(before.shape[0] + 1))
        return csr_array((data[order], indices[order], start), before.shape)


def _carried(distances: BoneDistances, skeleton: Skeleton, method: Method) -> Bones | None:
    """Return the moved bones, leaf bones as long as before; None if there are other bones."""
    old = distances.bones
    bones, aimed = distances.solver.bones(skeleton, method.leaf)
    if not np.array_equal(bones.joint, old.joint):
        return None
    carried = old.end + bones.start - old.start
    return Bones(bones.start, np.where(aimed[:, None], carried, bones.end), bones.joint)
