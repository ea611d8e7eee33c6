"""A rig under diagnosis, with properties that are computed on first use."""

from __future__ import annotations

from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from ..bones.bones import Bones
from ..geodesics import BoneDistances, bone_distances
from ..geometry.edges import MeshEdges, find_edges
from ..geometry.segments import distance_to_segment
from ..geometry.triangles import areas, label_components
from ..graph import CutCellGraph, build_graph
from ..graph.orientation.orient import flipped
from ..graph.surface import WALL
from ..graph.winding.boundary import Boundary, boundary_of
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

    @cached_property
    def first(self) -> NDArray[np.intp]:
        """The first vertex of the file at each welded vertex, shape (k,)."""
        return np.unique(self.welded, return_index=True)[1]

    @cached_property
    def points(self) -> NDArray[np.float64]:
        """Welded vertices in the unit cube, shape (k, 3)."""
        return self.graph.nodes[: self.graph.first_point]

    @cached_property
    def is_used(self) -> NDArray[np.bool_]:
        """Whether a face uses each vertex of the file, but for walls of voids, shape (n,)."""
        used = np.zeros(len(self.welded), bool)
        used[self.rig.mesh.faces[self.graph.omitted != WALL]] = True
        return used

    @cached_property
    def is_collapsed(self) -> NDArray[np.bool_]:
        """Which faces have a repeated corner in the graph, shape (m,)."""
        a, b, c = self.graph.faces.T
        return np.asarray((a == b) | (b == c) | (c == a))

    @cached_property
    def whole(self) -> NDArray[np.intp]:
        """The faces that have not collapsed."""
        return np.flatnonzero(~self.is_collapsed)

    @cached_property
    def faces(self) -> NDArray[np.int32]:
        """`whole` with welded vertices and the orientation of the file, shape (w, 3)."""
        return self.welded[self.rig.mesh.faces[self.whole]]

    @cached_property
    def edges(self) -> MeshEdges:
        """The edges of `faces` once they all face outward."""
        return find_edges(self.graph.faces[self.whole])

    @cached_property
    def boundary(self) -> Boundary:
        """Loops of edges that the faces leave open."""
        return boundary_of(self.edges.edges, self.edges.incidence)

    @cached_property
    def areas(self) -> NDArray[np.float64]:
        """The area of each face of the file in the unit cube, shape (m,)."""
        return areas(self.points[self.welded[self.rig.mesh.faces]])

    @cached_property
    def place_areas(self) -> NDArray[np.float64]:
        """A third of the areas of the faces around each welded vertex, shape (k,)."""
        corners = self.welded[self.rig.mesh.faces].ravel()
        thirds = np.repeat(self.areas / 3, 3)
        return np.bincount(corners, thirds, len(self.points)).astype(np.float64)

    @property
    def vertex_areas(self) -> NDArray[np.float64]:
        """`place_areas` divided among the vertices of the file at each place, shape (n,)."""
        shared = np.bincount(self.welded, minlength=len(self.points))
        return np.asarray((self.place_areas / shared)[self.welded])

    @cached_property
    def component(self) -> NDArray[np.int32]:
        """The connected component of each welded vertex, shape (k,)."""
        return label_components(self.graph.faces, len(self.points))

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
    def guess(self) -> DeformJoints:
        """Which joints move skin, by names and places."""
        return deform_joints(self.rig.mesh, self.rig.skeleton, self.body)

    def area_share(self, faces: NDArray[np.intp]) -> str:
        """Return the part of the surface that some faces cover, as a text."""
        return share(self.areas[faces].sum(), self.areas.sum())

    def vertices_at(self, places: NDArray) -> NDArray[np.intp]:
        """Return the vertices of the file at some welded vertices: their numbers, or a mask."""
        at = np.zeros(len(self.points), bool)
        at[places] = True
        return np.flatnonzero(at[self.welded] & self.is_used)

    def name(self, joint: int | np.integer) -> str:
        """Return the name of a joint as it is shown."""
        return shown_name(self.rig.skeleton.names[joint])
