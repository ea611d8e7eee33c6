"""Distances from every bone to every vertex through the body (paper section 3.2)."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any, Unpack

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array

from ..bones.bones import Bones, Sources, least_of_joints, per_joint
from ..checks import check_integer, check_number
from ..errors import ParameterError, SkeletonError
from ..graph import CutCellGraph
from ..graph.fingerprint import Fingerprint, distance_fingerprint
from ..method import ANIMATION, DistanceOptions, Method, MethodName, method_of
from ..rig import Skeleton
from ..rig.checks import check_positions
from ..rig.inputs import SkeletonLike, as_skeleton
from ..rig.rig import check_units
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
    at_welded : array, shape (j, k), float64
        `joint` per welded vertex: the k first nodes of the graph. Where vertices at one place
        may follow different joints, that of the first one.
    of_vertices : array, shape (j, n), or None
        `joint`, if vertices at one place may follow different joints.
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

    at_welded: NDArray[np.float64]
    of_vertices: NDArray[np.float64] | None
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
            "joints": len(self.at_welded),
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

    @property
    def rows(self) -> csr_array:
        """`joint` per welded vertex, shape (k, j): an explicit entry for each measured joint."""
        vertex, joint = np.nonzero(np.isfinite(self.at_welded.T))
        start = np.searchsorted(vertex, np.arange(self.at_welded.shape[1] + 1)).astype(np.int32)
        shape = self.at_welded.shape[::-1]
        return csr_array((self.at_welded[joint, vertex], joint.astype(np.int32), start), shape)

    @cached_property
    def joint(self) -> NDArray[np.float64]:
        """Distances from joints to vertices, shape (j, n), float64.

        The minimum over the bones of each joint; infinite where no path leads, for joints that
        may not carry weight, and for joints that are not among the nearest of a vertex. n is the
        number of vertices of the mesh as given.
        """
        if self.of_vertices is not None:
            return self.of_vertices
        return self.at_welded.take(self.graph.vertex_node, axis=1)

    def at(self, joint: Any, vertex: Any) -> NDArray[np.float64]:
        """Return the distances from some joints to some vertices, indexed as `joint` would be.

        Unlike `joint` it keeps nothing in memory.
        """
        if self.of_vertices is not None:
            return np.asarray(self.of_vertices[joint, vertex])
        return np.asarray(self.at_welded[joint, self.graph.vertex_node[vertex]])

    @property
    def nearest_joint(self) -> NDArray[np.intp]:
        """The joint that is nearest to each vertex, shape (n,)."""
        return self._over_joints(np.argmin)

    @property
    def least(self) -> NDArray[np.float64]:
        """The distance of the nearest joint to each vertex, shape (n,)."""
        return self._over_joints(np.min)

    def _over_joints(self, reduce: Callable[..., NDArray[Any]]) -> NDArray[Any]:
        """Reduce distances over the joints, (n,)."""
        if self.of_vertices is not None:
            return reduce(self.of_vertices, axis=0)
        return reduce(self.at_welded, axis=0)[self.graph.vertex_node]

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
        return self.solver.paths(bones, sources, targets=everywhere)[0]

    def on_mesh(self, joint: int) -> NDArray[np.float64]:
        """Compute a joint's distance at every vertex, nearest joint or not, shape (n,).

        Vertices not reached through the body have their value in `joint`. See `field` for errors.
        """
        through = self.field(joint)[self.graph.vertex_node]
        return np.where(self.fallback == REACHED, through, self.joint[joint])

    def all_joints(self, progress: Progress = silent) -> NDArray[np.float64]:
        """Compute the distances of all joints at every vertex, nearest or not, shape (j, n)."""
        if self.nearest_joints is None:
            return self.joint
        by_node = self.solver.paths(self.bones, self.sources, progress=progress)
        joint = self.joint.copy()
        reached = np.flatnonzero(self.fallback == REACHED)
        joint[np.ix_(np.unique(self.bones.joint), reached)] = by_node[
            :, self.graph.vertex_node[reached]
        ]
        if self.allowed is not None:
            joint[~self.allowed.T] = np.inf
        return joint


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
    if allowed is None:
        node = solver.targets
        by_node = solver.paths(bones, sources, nearest_joints, within, progress=progress)
        joint = per_joint(by_node, bones, len(skeleton.joints))
    else:  # per vertex, as those at one place may differ
        node = graph.vertex_node
        joint, nearest_joints = allowed_distances(
            solver, bones, sources, nearest_joints, within, allowed, progress
        )
    fallback = why_not_reached(solver, bones, sources, joint, node, allowed)
    lost = np.flatnonzero(fallback != REACHED)
    if len(lost):
        may_follow = None if allowed is None else allowed[np.ix_(lost, bones.joint)]
        straight = straight_to_nearest(graph.nodes[node[lost]], bones, nearest, may_follow)
        joint[:, lost] = per_joint(least_of_joints(straight, bones), bones, len(joint))
    of_vertices = None if allowed is None else joint
    if allowed is None:
        fallback = fallback[graph.vertex_node]
    else:
        joint = joint[:, np.unique(node, return_index=True)[1]]
    distances = BoneDistances(
        joint, of_vertices, nearest_joints, bones, sources, fallback, solver, skeleton, allowed
    )
    within = within if nearest_joints else np.inf
    own = distance_fingerprint(skeleton, method, allowed, nearest_joints, within, nearest)
    return distances.identified(graph.fingerprint and {**graph.fingerprint, **own})
