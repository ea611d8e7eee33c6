"""A rig prepared for the methods: welded, in the unit cube, with its bones."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from cutcell.geodesics import Bones, bone_segments
from cutcell.geodesics.fallback import straight_to_nearest
from cutcell.geometry.segments import closest_on_segment, distance_to_segment
from cutcell.geometry.welded import WeldedMesh
from cutcell.graph import Lattice
from cutcell.method import Leaf
from cutcell.rig import Rig

NEAREST = 3
"""Bones that a vertex follows which none reaches."""


@dataclass(frozen=True, eq=False)
class Body:
    """A welded mesh and its bones, in the unit cube."""

    mesh: WeldedMesh  # no face of it has collapsed
    bones: Bones
    joints: int  # of the skeleton, with or without bones
    lattice: Lattice

    @classmethod
    def of(cls, rig: Rig, leaf: Leaf = "point", resolution: int = 64) -> Body:
        """Prepare a rig; see `bone_segments` for `leaf`, `Lattice.around` for `resolution`."""
        lattice, mesh = Lattice.around(rig.mesh, resolution), rig.mesh.welded
        mesh = replace(mesh, faces=mesh.faces[mesh.is_whole])
        bones = bone_segments(rig.skeleton, leaf)
        bones = replace(bones, start=lattice.to_unit(bones.start), end=lattice.to_unit(bones.end))
        return cls(mesh, bones, len(rig.skeleton.joints), lattice)

    @property
    def points(self) -> NDArray[np.float64]:
        """The welded vertices, shape (k, 3)."""
        return self.mesh.points

    @property
    def faces(self) -> NDArray[np.int32]:
        """The faces of `mesh`, shape (m, 3)."""
        return self.mesh.faces

    @property
    def index(self) -> NDArray[np.int32]:
        """The welded vertex of each vertex of the file, shape (n,)."""
        return self.mesh.index

    def straight(self) -> NDArray[np.float64]:
        """Measure from every bone straight to every welded vertex, shape (b, k)."""
        ends = zip(self.bones.start, self.bones.end, strict=True)
        return np.stack([distance_to_segment(self.points, start, end) for start, end in ends])

    def closest_on(self, bone: int) -> NDArray[np.float64]:
        """Return the point of a bone that is closest to each welded vertex, shape (k, 3)."""
        return closest_on_segment(self.points, self.bones.start[bone], self.bones.end[bone])[0]

    def joint_minimum(self, distance: NDArray[np.float64]) -> NDArray[np.float64]:
        """Take the least over the bones of each joint: (b, k) to (j, k), else infinite."""
        joint = np.full((self.joints, distance.shape[1]), np.inf)
        first = np.flatnonzero(np.diff(self.bones.joint, prepend=-1))
        joint[self.bones.joint[first]] = np.minimum.reduceat(distance, first, axis=0)
        return joint


class Same:
    """A body and an option as a key: equal where all their numbers are."""

    def __init__(self, body: Body, option: float) -> None:
        self.body, self.option = body, option
        bones = body.bones
        arrays = (body.points, body.faces, bones.start, bones.end, bones.joint)
        self._key = (option, *(array.tobytes() for array in arrays))

    def __hash__(self) -> int:
        return hash(self._key)

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Same) and self._key == other._key


def follow_nearest(body: Body, distance: NDArray[np.float64], why: str) -> tuple[str, ...]:
    """Give vertices that no bone reaches straight distances to their nearest bones, in place.

    Shapes: distance (b, k).
    """
    lost = np.flatnonzero(~np.isfinite(distance).any(axis=0))
    if len(lost) == 0:
        return ()
    distance[:, lost] = straight_to_nearest(body.points[lost], body.bones, NEAREST)
    return (unreached(lost, body, why),)


def unreached(lost: NDArray[np.intp], body: Body, why: str) -> str:
    """Say how many vertices follow their nearest bones, and why."""
    return (
        f"{len(lost):,} of {len(body.points):,} welded vertices follow their nearest bones in a "
        f"straight line: {why}"
    )
