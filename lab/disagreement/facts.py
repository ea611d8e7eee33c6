"""Facts about a region of the surface and two joints, measured through the graph."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from cutcell.diagnosis.subject import Subject
from cutcell.geodesics import BoneDistances
from cutcell.geodesics.fallback import REACHED
from cutcell.geometry.segments import closest_on_segment
from cutcell.graph import INTERIOR
from cutcell.rig import Rig
from cutcell.rig.rows import to_dense

SAMPLES = 48
"""Vertices of a region that are measured."""
MOST = 0.5
"""Part of a region for which a fact must hold."""
STEPS = 8
"""Samples of a straight line in each lattice cell."""
MAX_STEPS = 512
"""The same of a whole line."""

Pair = tuple[float, float]


@dataclass(frozen=True, eq=False)
class Facts:
    """Measurements of a region and of two joints: medians over samples, in the unit cube.

    Parameters
    ----------
    joints : pair of int
    through, straight : pair of float
        Distance from each joint through the body, infinite without a path, and in a straight line.
    gap : pair of float
        Length of the straight line outside the body.
    is_past_end : pair of bool
        Whether the region lies beyond the end of the joint's bone.
    nearest : float
        Distance of the nearest joint.
    depth : float
        Distance from the nearest lattice point inside; infinite if there is none.
    """

    joints: tuple[int, int]
    through: Pair
    straight: Pair
    gap: Pair
    is_past_end: tuple[bool, bool]
    nearest: float
    depth: float


class Measured:
    """A rig with its distances, and facts about its parts and bones.

    Parameters
    ----------
    rig : Rig
    distances : BoneDistances
    """

    def __init__(self, rig: Rig, distances: BoneDistances) -> None:
        self.rig, self.distances = rig, distances
        self.cells = distances.graph.lattice.resolution
        self.subject = Subject(rig, self.cells, distances)

    @cached_property
    def component(self) -> NDArray[np.int32]:
        """The connected component of each vertex of the file, shape (n,)."""
        return self.subject.component[self.subject.welded]

    @cached_property
    def sizes(self) -> NDArray[np.intp]:
        """How many vertices each component has."""
        return np.bincount(self.component[self.subject.is_used])

    def members(self, labels: NDArray[np.integer]) -> NDArray[np.intp]:
        """Return the vertices of some components."""
        return np.flatnonzero(np.isin(self.component, labels) & self.subject.is_used)

    def facts(self, vertices: NDArray[np.intp], joints: tuple[int, int]) -> Facts:
        """Measure a region; some of its vertices are reached, and both joints have bones."""
        distances, bones = self.distances, self.distances.bones
        reached = vertices[distances.fallback[vertices] == REACHED]
        samples = reached[:: -(-len(reached) // SAMPLES)]
        chosen = np.isin(bones.joint, joints)
        targets, number = np.unique(self.subject.welded[samples], return_inverse=True)
        by_node = distances.solver.paths(
            bones.subset(chosen), distances.sources.subset(chosen), targets=targets.astype(np.int32)
        )
        by_node = to_dense(by_node[number]).T
        through = dict(zip(np.unique(bones.joint[chosen]).tolist(), by_node, strict=True))
        nearest = distances.at(slice(None), samples).min(axis=0)
        points = self.subject.points[self.subject.welded[samples]]
        one, other = (self._line(points, joint) for joint in joints)
        inside = self._inside
        return Facts(
            joints,
            (_median(through[joints[0]]), _median(through[joints[1]])),
            (_median(one.length), _median(other.length)),
            (_median(one.outside), _median(other.outside)),
            (bool(one.past.mean() >= MOST), bool(other.past.mean() >= MOST)),
            _median(np.minimum(nearest, by_node.min(axis=0))),
            np.inf if inside is None else _median(inside.query(points)[0]),
        )

    def lie_together(self, joints: tuple[int, int], cells: float) -> bool:
        """Return whether bones of two joints lie along each other, within some lattice cells."""
        bones = self.distances.bones
        one, other = (np.flatnonzero(bones.joint == joint) for joint in joints)
        middle = (bones.start[one] + bones.end[one])[:, None] / 2
        near, part = closest_on_segment(middle, bones.start[other], bones.end[other])
        is_close = np.linalg.norm(near - middle, axis=-1) * self.cells < cells
        return bool((is_close & (part > 0) & (part < 1)).any())

    def is_last(self, joint: int) -> bool:
        """Return whether no joint below has a bone."""
        below = np.flatnonzero(self.rig.skeleton.subtree[joint])
        return not np.isin(below[below != joint], self.distances.bones.joint).any()

    def bone_length(self, joints: tuple[int, int]) -> float:
        """Return the length of the longest bone of two joints."""
        bones = self.distances.bones
        chosen = np.isin(bones.joint, joints)
        lengths = np.linalg.norm(bones.end[chosen] - bones.start[chosen], axis=1)
        return float(lengths.max(initial=0))

    def steps_between(self, one: int, other: int) -> float:
        """Return the number of steps along the skeleton from one joint to another."""
        above = self.rig.skeleton.subtree[:, [one, other]]
        shared = int(above.all(axis=1).sum())
        return int(above.sum()) - 2 * shared if shared else np.inf

    @cached_property
    def _inside(self) -> cKDTree | None:
        graph = self.distances.graph
        inside = graph.nodes[graph.node_kind == INTERIOR]
        return cKDTree(inside) if len(inside) else None

    def _line(self, points: NDArray[np.float64], joint: int) -> _Line:
        bones, skeleton = self.distances.bones, self.rig.skeleton
        of_joint, every = np.flatnonzero(bones.joint == joint), np.arange(len(points))
        near = closest_on_segment(points[:, None], bones.start[of_joint], bones.end[of_joint])[0]
        gap = np.linalg.norm(near - points[:, None], axis=2)
        best = gap.argmin(axis=1)
        near, length, bone = near[every, best], gap[every, best], of_joint[best]
        axis = bones.end[bone] - bones.start[bone]
        if skeleton.parents[joint] >= 0:  # a bone without length points as the one before it
            before = skeleton.joints[joint] - skeleton.joints[skeleton.parents[joint]]
            axis = np.where(axis.any(axis=1, keepdims=True), axis, before)
        axis /= np.maximum(np.linalg.norm(axis, axis=1, keepdims=True), 1e-300)
        past = np.einsum("ij,ij->i", points - bones.end[bone], axis)
        return _Line(length, past * self.cells > 1, self._outside(points, near, length))

    def _outside(
        self, start: NDArray[np.float64], end: NDArray[np.float64], length: NDArray[np.float64]
    ) -> NDArray[np.float64]:
        """Return the length outside the body of straight lines (s, 3), (s,)."""
        graph = self.distances.graph
        steps = int(np.clip(np.ceil(length.max() * self.cells * STEPS), 2, MAX_STEPS))
        along = (np.arange(steps) + 0.5) / steps
        points = start[:, None] + along[:, None] * (end - start)[:, None]
        number = graph.winding_numbers.at(points.reshape(-1, 3)).reshape(len(start), steps)
        part: NDArray[np.float64] = (number < graph.winding_threshold).mean(axis=1)
        return part * length


@dataclass(frozen=True, eq=False)
class _Line:
    """Straight lines from points to the nearest bone of a joint."""

    length: NDArray[np.float64]
    past: NDArray[np.bool_]
    outside: NDArray[np.float64]


def _median(values: NDArray[np.float64]) -> float:
    return float(np.median(values))
