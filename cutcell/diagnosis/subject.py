"""A rig under diagnosis, with properties that are computed on first use."""

from __future__ import annotations

from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from ..bones.bones import Bones
from ..editing.symmetry import Mirror, find_mirror
from ..errors import MeshError
from ..geodesics import BoneDistances, bone_distances
from ..geometry.segments import distance_to_segment
from ..geometry.welded import WeldedMesh
from ..graph import CutCellGraph, build_graph
from ..graph.orientation.orient import flipped
from ..graph.surface import WALL
from ..rig import Rig, TriangleMesh
from ..rig.deform_joints import DeformJoints, deform_joints
from ..rig.deform_joints.body import Body
from ..runtime.display import share, shown_name
from ..runtime.progress import Progress, silent

MAX_OUTSIDE_BODY = 0.05
"""Part of the longest side: joints farther from the body have no distances through it."""


def bones_distance(bones: Bones, joint: int, points: NDArray[np.float64]) -> NDArray[np.float64]:
    """Measure from points (p, 3) straight to the nearest bone of a joint."""
    own = np.flatnonzero(bones.joint == joint)
    return np.min([distance_to_segment(points, bones.start[b], bones.end[b]) for b in own], axis=0)


class Subject:
    """A rig and the properties that its checks share."""

    def __init__(
        self,
        rig: Rig,
        resolution: int = 64,
        distances: BoneDistances | None = None,
        progress: Progress = silent,
    ) -> None:
        self.rig, self.resolution, self.progress = rig, resolution, progress
        if distances is not None:
            self.distances, self.graph = distances, distances.graph

    @cached_property
    def graph(self) -> CutCellGraph:
        """The cut-cell graph."""
        mesh, resolution = self.rig.mesh, self.resolution
        return build_graph(mesh, resolution, connectivity="any", progress=self.progress)

    @cached_property
    def distances(self) -> BoneDistances:
        """Distances from bones to the vertices, of a rig with joints."""
        return bone_distances(
            self.graph,
            self.rig.skeleton,
            leaf="fit",
            nearest_joints=3,
            within=np.inf,
            allowed=self.rig.allowed,
            progress=self.progress,
        )

    @property
    def weights(self) -> NDArray[np.float64]:
        """The weights of a rig that has some."""
        assert self.rig.weights is not None
        return self.rig.weights

    @cached_property
    def measurable(self) -> NDArray[np.bool_]:
        """Which joints have distances through the body, shape (j,)."""
        has_bone = np.isin(np.arange(len(self.joint_distance)), self.distances.bones.joint)
        return has_bone & (self.joint_distance <= MAX_OUTSIDE_BODY)

    @property
    def welded(self) -> NDArray[np.int32]:
        """The welded vertex of each vertex of the file, shape (n,)."""
        return self.graph.vertex_node

    @property
    def mesh(self) -> WeldedMesh:
        """The graph's mesh, whose faces look outward."""
        return self.graph.mesh

    @cached_property
    def is_used(self) -> NDArray[np.bool_]:
        """Whether a face uses each vertex of the file, but for walls of voids, shape (n,)."""
        used = np.zeros(len(self.welded), bool)
        used[self.rig.mesh.faces[self.graph.omitted != WALL]] = True
        return used

    @cached_property
    def whole(self) -> NDArray[np.intp]:
        """The faces that have not collapsed."""
        return np.flatnonzero(self.mesh.is_whole)

    @cached_property
    def faces(self) -> NDArray[np.int32]:
        """The corners of `whole`, which look outward, shape (w, 3)."""
        return self.mesh.faces[self.whole]

    @property
    def areas(self) -> NDArray[np.float64]:
        """The area of each face of the file in the unit cube, shape (m,)."""
        return self.rig.mesh.welded.face_areas

    @property
    def vertex_areas(self) -> NDArray[np.float64]:
        """The areas around welded vertices divided among the vertices of the file, shape (n,)."""
        return np.asarray((self.mesh.areas / np.bincount(self.welded))[self.welded])

    def weight_share(
        self, vertices: NDArray[np.intp], parts: NDArray[np.floating] | float = 1.0
    ) -> float:
        """Return parts of the weight of vertices, shapes (k,), as a part of all weight, by area."""
        area = self.vertex_areas
        return float((area[vertices] * parts).sum() / area.sum())

    @cached_property
    def body(self) -> Body:
        """Classifier of points near the surface: inside or outside."""
        faces = flipped(self.rig.mesh.faces, self.graph.inverted)
        return Body(TriangleMesh(self.rig.mesh.vertices, faces[self.graph.omitted == 0]))

    @cached_property
    def joint_distance(self) -> NDArray[np.float64]:
        """How far each joint is from the body, in the unit cube; 0 inside; shape (j,)."""
        return self.body.away(self.body.to_unit(self.rig.skeleton.joints))

    @cached_property
    def mirror(self) -> Mirror | None:
        """The plane of symmetry; None for a mesh that is not mirrored."""
        try:
            return find_mirror(self.rig)
        except MeshError:
            return None

    @cached_property
    def guess(self) -> DeformJoints:
        """Which joints move skin, by names and places."""
        return deform_joints(self.rig.mesh, self.rig.skeleton, self.body)

    def area_share(self, faces: NDArray[np.intp]) -> str:
        """Return the part of the surface that some faces cover, as a text."""
        return share(self.areas[faces].sum(), self.areas.sum())

    def vertices_at(self, places: NDArray) -> NDArray[np.intp]:
        """Return the vertices of the file at some welded vertices: their numbers, or a mask."""
        at = np.zeros(len(self.mesh.points), bool)
        at[places] = True
        return np.flatnonzero(at[self.welded] & self.is_used)

    def name(self, joint: int | np.integer) -> str:
        """Return the name of a joint as it is shown."""
        return shown_name(self.rig.skeleton.names[joint])
