"""Distances while joints are being moved: only those of changed bones are measured."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from cutcell.animation.any_angle.theta_star import ON_BONE
from cutcell.bones.bones import Bones
from cutcell.geodesics.distances import BoneDistances, bone_distances
from cutcell.geodesics.fallback import REACHED
from cutcell.graph.fingerprint import APPROXIMATE
from cutcell.method import Method
from cutcell.rig import Skeleton


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
        self._farthest = np.where(np.isinf(distances.at_welded), 0, distances.at_welded).max(axis=0)
        self._reached = np.zeros(distances.graph.first_point, np.bool_)
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
            at_welded=self._merged(joints, fresh),
            bones=bones,
            sources=distances.sources.replaced(is_moved, sources),
            skeleton=skeleton,
        ).identified(APPROXIMATE)

    def _merged(self, joints: NDArray[np.intp], fresh: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return the distances of all joints, with those of some joints replaced."""
        distances, merged = self._distances, self._distances.at_welded.copy()
        before = merged[joints]
        after = np.where(self._reached, fresh, before)
        if distances.nearest_joints is not None:
            after[(after > self._farthest) & np.isinf(before)] = np.inf
        merged[joints] = after
        if distances.nearest_joints is not None:
            least = merged.min(axis=0)
            lost = np.isinf(least)
            after[:, lost] = before[:, lost]
            least = np.maximum(least, ON_BONE / distances.graph.lattice.resolution)
            after[(after > self._within * least) & self._reached] = np.inf
            merged[joints] = after
        return merged


def _carried(distances: BoneDistances, skeleton: Skeleton, method: Method) -> Bones | None:
    """Return the moved bones, leaf bones as long as before; None if there are other bones."""
    old = distances.bones
    bones, aimed = distances.solver.bones(skeleton, method.leaf)
    if not np.array_equal(bones.joint, old.joint):
        return None
    carried = old.end + bones.start - old.start
    return Bones(bones.start, np.where(aimed[:, None], carried, bones.end), bones.joint)
