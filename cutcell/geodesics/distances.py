"""Distances from every bone to every vertex through the body (paper section 3.2)."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any, Unpack

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array

from ..bones.bones import Bones, Sources, least_of_joints
from ..checks import check_integer, check_number
from ..errors import ParameterError, SkeletonError
from ..graph import CutCellGraph
from ..graph.fingerprint import Fingerprint, distance_fingerprint
from ..method import ANIMATION, DistanceOptions, Method, MethodName, method_of
from ..rig import Skeleton
from ..rig.checks import check_positions
from ..rig.inputs import SkeletonLike, as_skeleton
from ..rig.rig import check_units
from ..rig.rows import (
    chosen_entries,
    column_of_least,
    from_dense,
    least,
    lookup,
    rows_of_entries,
    to_dense,
    with_columns,
    with_rows,
)
from ..runtime.progress import Progress, silent
from ..runtime.repr import Summarized
from .allowed import allowed_distances, check_allowed
from .fallback import REACHED, straight_to_nearest, why_not_reached
from .solver import BoneDistanceSolver
from .tracing.inside import Inside


@dataclass(frozen=True, eq=False, repr=False)
class BoneDistances(Summarized):
    """Distances from bones and joints to the vertices of a mesh, in the unit cube.

    Parameters
    ----------
    rows : csr_array, shape (k, j)
        The distances from the joints that were measured at each welded vertex: the k first nodes
        of the graph. Joints ascend; an entry may be 0. Where vertices at one place may follow
        different joints, those of the first one.
    of_vertices : csr_array, shape (n, j), or None
        The rows of all vertices, if vertices at one place may follow different joints.
    nearest_joints : int or None
        Each vertex has the distances of at least this many of its nearest joints; None: of all.
    bones : Bones
        In the unit cube.
    sources : Sources
        The nodes where paths begin.
    fallback : array, shape (n,), uint8
        0 for vertices reached through the body, else the reason why not, an index into
        `geodesics.FALLBACK_REASONS`. These have straight distances to a few bones.
    solver : BoneDistanceSolver
        Solver that computed them, for more distances along the same graph.
    skeleton : Skeleton or None
        Skeleton of the bones; None if bones were given.
    allowed : array, shape (n, j), bool, or None
        Which joints each vertex may follow; None: all.

    Attributes
    ----------
    fingerprint : mapping
        Fingerprint of graph, skeleton and options; empty in a copy by `replace`.
    """

    rows: csr_array
    of_vertices: csr_array | None
    nearest_joints: int | None
    bones: Bones
    sources: Sources
    fallback: NDArray[np.uint8]
    solver: BoneDistanceSolver
    skeleton: Skeleton | None = None
    allowed: NDArray[np.bool_] | None = None
    fingerprint: Fingerprint = field(init=False, default_factory=dict)

    def identified(self, fingerprint: Fingerprint) -> BoneDistances:
        """Set the fingerprint of new distances; return them."""
        object.__setattr__(self, "fingerprint", fingerprint)
        return self

    @property
    def _summary(self) -> dict[str, Any]:
        return {
            "joints": self.rows.shape[1],
            "vertices": len(self.fallback),
            "unreached_vertices": int(np.count_nonzero(self.fallback)),
            "bones": len(self.bones.joint),
            "sources": len(self.sources.node),
            "nearest_joints": self.nearest_joints or "all",
        }

    @property
    def graph(self) -> CutCellGraph:
        """The graph that paths run along."""
        return self.solver.graph

    def _rows_at(self, vertex: Any) -> csr_array:
        """Return the rows of some vertices, indexed as an array of shape (n,)."""
        if self.of_vertices is not None:
            return self.of_vertices[vertex]
        return self.rows[self.graph.vertex_node[vertex]]

    @property
    def joint(self) -> NDArray[np.float64]:
        """Distances from joints to vertices, shape (j, n), float64, made on access.

        The minimum over the bones of each joint; infinite where no path leads, for joints that
        may not carry weight, and for joints that are not among the nearest of a vertex. n is the
        number of vertices of the mesh as given.
        """
        return to_dense(self._rows_at(slice(None))).T

    def at(self, joint: Any, vertex: Any) -> NDArray[np.float64]:
        """Return the distances from some joints to some vertices, indexed as `joint` would be."""
        number, vertices = (
            np.arange(self.rows.shape[1])[joint],
            np.arange(len(self.fallback))[vertex],
        )
        if vertices.ndim and (isinstance(joint, slice) or isinstance(vertex, slice)):
            number = number[..., None]
        row = np.arange(vertices.size).reshape(vertices.shape)
        return lookup(self._rows_at(vertices.ravel()), row, number)

    @property
    def nearest_joint(self) -> NDArray[np.intp]:
        """The joint that is nearest to each vertex, shape (n,)."""
        return self._over_joints(column_of_least)

    @property
    def least(self) -> NDArray[np.float64]:
        """The distance of the nearest joint to each vertex, shape (n,)."""
        return self._over_joints(least)

    def _over_joints(self, reduce: Callable[[csr_array], NDArray[Any]]) -> NDArray[Any]:
        """Reduce distances over the joints, (n,)."""
        if self.of_vertices is not None:
            return reduce(self.of_vertices)
        return reduce(self.rows)[self.graph.vertex_node]

    @cached_property
    def inside(self) -> Inside:
        """The test for straight segments inside the body."""
        return Inside(self.graph, self.solver.contraction)

    def field(self, joint: int) -> NDArray[np.float64]:
        """Compute a joint's distance at every node of the graph, shape (N,).

        Raises
        ------
        ParameterError
            `joint` is no joint that may carry weight.
        """
        if joint not in self.bones.joint:
            raise ParameterError(f"joint {joint} has no bone: it may not carry weight")
        of_joint = self.bones.joint == joint
        bones, sources = self.bones.subset(of_joint), self.sources.subset(of_joint)
        everywhere = np.arange(len(self.graph.nodes), dtype=np.int32)
        return to_dense(self.solver.paths(bones, sources, targets=everywhere))[:, 0]

    def on_mesh(self, joint: int) -> NDArray[np.float64]:
        """Compute a joint's distance at every vertex, nearest joint or not, shape (n,).

        Vertices not reached through the body have their value in `joint`. See `field` for errors.
        """
        through = self.field(joint)[self.graph.vertex_node]
        return np.where(self.fallback == REACHED, through, self.at(joint, slice(None)))

    def of_all_joints(self, progress: Progress = silent) -> BoneDistances:
        """Compute the distances of all joints at every vertex, nearest or not."""
        if self.nearest_joints is None:
            return self
        by_node = self.solver.paths(self.bones, self.sources, progress=progress)
        columns = np.unique(self.bones.joint), self.rows.shape[1]
        rows = with_columns(by_node[self.graph.vertex_node], *columns)
        if self.allowed is not None:
            rows = chosen_entries(rows, self.allowed[rows_of_entries(rows), rows.indices])
        lost = np.flatnonzero(self.fallback != REACHED)
        rows = with_rows(rows, lost, self._rows_at(lost))
        first = np.unique(self.graph.vertex_node, return_index=True)[1]
        return replace(self, rows=rows[first], of_vertices=rows, nearest_joints=None)


def bone_distances(
    graph: CutCellGraph | BoneDistanceSolver,
    skeleton: SkeletonLike,
    *,
    method: Method | MethodName = ANIMATION,
    nearest: int = 3,
    nearest_joints: int | None = None,
    within: float | None = None,
    allowed: NDArray[np.bool_] | None = None,
    progress: Progress = silent,
    **options: Unpack[DistanceOptions],
) -> BoneDistances:
    """Compute the distance of each bone to each vertex along the graph.

    Parameters
    ----------
    graph : CutCellGraph or BoneDistanceSolver
        A solver is a graph that was prepared before, such as the `solver` of other distances.
    skeleton : Skeleton or (joints, parents)
        In the units of the graph's mesh.
    method : Method, "animation" or "paper"
        Its samples and leaf bones count here, and of how many joints its falloff needs
        distances. Paths run as the graph was built for.
    nearest : int
        Number of bones that a vertex without a path follows, 1 or more.
    nearest_joints : int, optional
        Number of nearest joints to measure from at each vertex, 1 or more; at most as many others
        are measured, too. By default the number that the method needs: all for
        `cutcell.PAPER`. Fewer take less time with connectivity "any"; with others all are
        measured, as they are where `allowed` has nearly as many different rows as joints.
    within : float, optional
        Leave out joints farther than this factor times the nearest, 1 or more; by default the
        factor of the method. Only where `nearest_joints` are measured, and to about half a
        lattice cell.
    allowed : array, shape (n, j), bool, optional
        Which joints each vertex may follow; see `Rig.allowed`.
    progress : callable
        See `cutcell.runtime.progress`; the stage is called "distances".
    **options
        Single options of the method: `samples`, `leaf`.

    Returns
    -------
    BoneDistances

    Raises
    ------
    ParameterError
        A parameter is out of its range.
    MeshError
        The mesh has collapsed into points.
    SkeletonError
        No joints, or one too far away from the mesh: they are in different units.
    WeightsError
        `allowed` has the wrong shape or leaves a vertex without any joint.

    References
    ----------
    Paper section 3.2, algorithm 2.
    """
    method = method_of(method, **options)
    nearest = check_integer("nearest", nearest, 1, 1_000_000)
    if nearest_joints is None:
        nearest_joints = method.joints_needed
    else:
        nearest_joints = check_integer("nearest_joints", nearest_joints, 1, 1_000_000)
    within = check_number("within", method.reach_needed if within is None else within, 1, np.inf)
    skeleton = as_skeleton(skeleton)
    skeleton.require_joints()
    check_positions(skeleton.joints, "joint", SkeletonError)
    solver = graph if isinstance(graph, BoneDistanceSolver) else BoneDistanceSolver(graph)
    graph = solver.graph
    offset = graph.lattice.offset
    check_units(skeleton, graph.lattice.to_file([offset, 1 - offset]))
    if graph.connectivity != "any":
        nearest_joints = None
    progress("distances", 0.0)
    if allowed is not None:
        allowed = check_allowed(graph, skeleton.deform, allowed)
        allowed = None if allowed.all() else allowed
    bones, sources = solver.place(skeleton, method, allowed, progress)
    joints = len(skeleton.joints)
    if allowed is None:
        node = solver.targets
        by_node = solver.paths(bones, sources, nearest_joints, within, progress=progress)
        rows = with_columns(by_node, np.unique(bones.joint), joints)
    else:  # per vertex, as those at one place may differ
        node, measure = graph.vertex_node, (solver, bones, sources, nearest_joints, within)
        rows, nearest_joints = allowed_distances(*measure, allowed, progress)
    fallback = why_not_reached(solver, bones, sources, rows, node, allowed)
    lost = np.flatnonzero(fallback != REACHED)
    if len(lost):
        may_follow = None if allowed is None else allowed[np.ix_(lost, bones.joint)]
        straight = straight_to_nearest(graph.nodes[node[lost]], bones, nearest, may_follow)
        of_joints = from_dense(least_of_joints(straight, bones).T)
        rows = with_rows(rows, lost, with_columns(of_joints, np.unique(bones.joint), joints))
    if allowed is None:
        of_vertices, fallback = None, fallback[graph.vertex_node]
    else:
        of_vertices, rows = rows, rows[np.unique(node, return_index=True)[1]]
    distances = BoneDistances(
        rows, of_vertices, nearest_joints, bones, sources, fallback, solver, skeleton, allowed
    )
    within = within if nearest_joints else np.inf
    own = distance_fingerprint(skeleton, method, allowed, nearest_joints, within, nearest)
    return distances.identified(graph.fingerprint and {**graph.fingerprint, **own})
