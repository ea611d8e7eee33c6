"""Distances from every bone to every vertex through the body (paper section 3.2)."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import Any, Unpack
from weakref import WeakKeyDictionary

import numpy as np
from numpy.typing import NDArray

from ..errors import ParameterError, SkeletonError, WeightsError
from ..graph import CutCellGraph
from ..method import ANIMATION, DistanceOptions, Method, MethodName, method_of
from ..rig.checks import check_integer, check_number, check_positions
from ..rig.rig import Skeleton
from ..runtime.progress import Progress, silent
from ..runtime.threads import submit
from .any_angle.contraction import Contraction, contract
from .any_angle.theta_star import any_angle_paths, least_distances
from .bone_extents.fit import REGION_LEAVES, REGION_WITHIN, aim_leaf_bones, fit_bones
from .bones import Bones, Sources, bone_segments, find_sources, node_grid
from .fallback import NOT_ALLOWED, REACHED, UNREACHED, UNUSED, straight_to_nearest
from .nearest import NodeGrid
from .shortest_paths import shortest_paths
from .tracing.inside import Inside


@dataclass(frozen=True, eq=False)
class BoneDistances:
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
    graph : CutCellGraph
    contraction : Contraction or None
        Of the graph, with connectivity "any".
    """

    at_welded: NDArray[np.float64]
    of_vertices: NDArray[np.float64] | None
    nearest_joints: int | None
    bones: Bones
    sources: Sources
    fallback: NDArray[np.uint8]
    graph: CutCellGraph
    contraction: Contraction | None

    @cached_property
    def joint(self) -> NDArray[np.float64]:
        """Distances from joints to vertices, shape (j, n), float64.

        The minimum over the bones of each joint; infinite where no path leads, for joints that
        may not carry weight, and for joints that are not among a vertex' nearest. n is the
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
        if self.of_vertices is not None:
            return self.of_vertices.argmin(axis=0)
        return self.at_welded.argmin(axis=0)[self.graph.vertex_node]

    @property
    def least(self) -> NDArray[np.float64]:
        """The distance of the nearest joint to each vertex, shape (n,)."""
        if self.of_vertices is not None:
            return self.of_vertices.min(axis=0)
        return self.at_welded.min(axis=0)[self.graph.vertex_node]

    @cached_property
    def inside(self) -> Inside:
        """Tells which straight segments stay inside the body."""
        return Inside(self.graph, self.contraction)

    @property
    def source_node(self) -> NDArray[np.int32]:
        """Nodes where paths begin, shape (s,)."""
        return self.sources.node

    @property
    def source_bone(self) -> NDArray[np.int32]:
        """The bone of each source, shape (s,)."""
        return self.sources.bone

    @property
    def source_distance(self) -> NDArray[np.float64]:
        """Straight distance from each source to its bone, shape (s,)."""
        return self.sources.distance

    def field(self, joint: int) -> NDArray[np.float64]:
        """Compute a joint's distance at every node of the graph, shape (N,).

        Raises
        ------
        ParameterError
            `joint` is no joint that may carry weight.
        """
        if joint not in self.bones.joint:
            raise ParameterError(f"joint {joint} has no bone: it may not carry weight")
        mine = self.bones.joint == joint
        bones, sources = self.bones.some(mine), self.sources.some(mine)
        everywhere = np.arange(len(self.graph.nodes), dtype=np.int32)
        return joint_paths(self.graph, self.contraction, sources, bones, everywhere)[0]

    def on_mesh(self, joint: int) -> NDArray[np.float64]:
        """Compute a joint's distance at every vertex, nearest joint or not, shape (n,).

        Vertices not reached through the body have their value in `joint`.

        Raises
        ------
        ParameterError
            `joint` is no joint that may carry weight.
        """
        through = self.field(joint)[self.graph.vertex_node]
        return np.where(self.fallback == REACHED, through, self.joint[joint])

    def all_joints(self, progress: Progress = silent) -> NDArray[np.float64]:
        """Compute all joints' distances at every vertex, nearest or not, shape (j, n)."""
        if self.nearest_joints is None:
            return self.joint
        on_mesh = nodes_on_mesh(self.graph)
        known = self.graph, self.contraction, self.sources, self.bones
        by_node = joint_paths(*known, on_mesh, progress=progress)
        joint = self.joint.copy()
        reached = np.flatnonzero(self.fallback == REACHED)
        joint[np.ix_(np.unique(self.bones.joint), reached)] = by_node[
            :, self.graph.vertex_node[reached]
        ]
        return joint


def bone_distances(
    graph: CutCellGraph,
    skeleton: Skeleton,
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
    graph : CutCellGraph
    skeleton : Skeleton
        In the units of the graph's mesh.
    method : Method, "animation" or "paper"
        Its samples and leaf bones count here, and of how many joints its falloff needs
        distances. Paths run as the graph was built for.
    nearest : int
        How many bones a vertex follows that no path reaches, 1 or more.
    nearest_joints : int, optional
        Measure from so many of each vertex' nearest joints, 1 or more, and from at most as
        many others; from as many as the method needs when left out, which are all for
        `cutcell.PAPER`. Fewer take less time with connectivity "any"; with others they do not,
        and neither where `allowed` is given: then all are measured.
    within : float, optional
        Leave out joints that are so many times as far as the nearest, 1 or more; as the method
        needs when left out. Only where `nearest_joints` are measured, and to about half a
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
        No joints, or one too far out to compute with.
    WeightsError
        `allowed` has the wrong shape or leaves a vertex without any joint.

    References
    ----------
    Paper section 3.2, algorithm 2.
    """
    method = method_of(method, **options)
    samples, leaf = method.samples, method.leaf
    nearest = check_integer("nearest", nearest, 1, 1_000_000)
    if nearest_joints is None:
        nearest_joints = method.joints_needed
    else:
        nearest_joints = check_integer("nearest_joints", nearest_joints, 1, 1_000_000)
    within = check_number("within", method.reach_needed if within is None else within, 1, np.inf)
    skeleton.require_joints()
    check_positions(skeleton.joints, "joint", SkeletonError)
    if graph.connectivity != "any" or allowed is not None:
        nearest_joints = None
    progress("distances", 0.0)
    if allowed is not None:
        _check_allowed(graph, skeleton, allowed)
    targets = nodes_on_mesh(graph)
    contracted = _contracted(graph) if graph.connectivity == "any" else None
    grid = sorted_nodes(graph)
    if leaf == "fit":
        bones, aimed = fit_bones(graph, skeleton, grid)
    else:
        bones = bone_segments(skeleton, leaf)
        ends = graph.lattice.to_unit(bones.start), graph.lattice.to_unit(bones.end)
        bones, aimed = Bones(*ends, bones.joint), np.zeros(len(bones.joint), np.bool_)
    contraction = None
    if contracted:
        contraction = _contractions[graph] = contracted()
    sources = find_sources(graph, bones, samples, grid, contraction)
    if aimed.any():
        reach = _reach_of_leaves(graph, contraction, sources, bones, aimed, progress)
        bones = aim_leaf_bones(graph, bones, aimed, *reach)
        of_aimed = find_sources(graph, bones.some(aimed), samples, grid, contraction)
        sources = sources.replaced(aimed, of_aimed)
    given = graph, contraction, sources, bones
    by_node = joint_paths(*given, targets, nearest_joints, within, progress=progress)
    measured, at_welded = np.unique(bones.joint), by_node
    if len(measured) < len(skeleton.joints):
        at_welded = np.full((len(skeleton.joints), len(targets)), np.inf)
        at_welded[measured] = by_node
    reached = np.isfinite(by_node.min(axis=0))
    fallback = np.where(reached, REACHED, UNREACHED).astype(np.uint8)
    fallback[~graph.connected[targets]] = UNUSED

    joint, node = at_welded, targets
    if allowed is not None:  # per vertex, as those at one place may differ
        node = graph.vertex_node
        joint, fallback = at_welded.take(node, axis=1), fallback[node]
        joint[~allowed.T] = np.inf
        fallback[(fallback == REACHED) & ~np.isfinite(joint).any(axis=0)] = NOT_ALLOWED
    lost = np.flatnonzero(fallback != REACHED)
    if len(lost):
        may_follow = None if allowed is None else allowed[np.ix_(lost, bones.joint)]
        straight = straight_to_nearest(graph.nodes[node[lost]], bones, nearest, may_follow)
        joint[np.ix_(measured, lost)] = _least(straight, bones)
    known = nearest_joints, bones, sources
    if allowed is None:
        return BoneDistances(joint, None, *known, fallback[graph.vertex_node], graph, contraction)
    first = np.unique(node, return_index=True)[1]
    return BoneDistances(joint[:, first], joint, *known, fallback, graph, contraction)


def distances_from(graph: CutCellGraph, bones: Bones, samples: int, joints: int) -> BoneDistances:
    """Compute the distances of given bones to each vertex along a graph."""
    contraction = _contracted(graph)() if graph.connectivity == "any" else None
    sources = find_sources(graph, bones, samples, sorted_nodes(graph), contraction)
    targets = nodes_on_mesh(graph)
    at_welded = np.full((joints, len(targets)), np.inf)
    at_welded[np.unique(bones.joint)] = joint_paths(graph, contraction, sources, bones, targets)
    is_reached = np.isfinite(at_welded.min(axis=0))[graph.vertex_node]
    fallback = np.where(is_reached, REACHED, UNREACHED).astype(np.uint8)
    return BoneDistances(at_welded, None, None, bones, sources, fallback, graph, contraction)


_contractions: WeakKeyDictionary[CutCellGraph, Contraction] = WeakKeyDictionary()
_grids: WeakKeyDictionary[CutCellGraph, NodeGrid] = WeakKeyDictionary()


def _contracted(graph: CutCellGraph) -> Callable[[], Contraction]:
    """Let another core contract a graph, unless it has been; return what waits for it."""
    found = _contractions.get(graph)
    return submit(lambda: contract(graph)) if found is None else lambda: found


def sorted_nodes(graph: CutCellGraph) -> NodeGrid:
    """Return the grid of a graph's nodes, which is made once for each graph."""
    if graph not in _grids:
        _grids[graph] = node_grid(graph)
    return _grids[graph]


def nodes_on_mesh(graph: CutCellGraph) -> NDArray[np.int32]:
    """List the welded vertices: the first nodes of the graph."""
    return np.arange(graph.first_point, dtype=np.int32)


def joint_paths(
    graph: CutCellGraph,
    contraction: Contraction | None,
    sources: Sources,
    bones: Bones,
    targets: NDArray[np.int32],
    nearest_joints: int | None = None,
    within: float = np.inf,
    least: NDArray[np.float64] | None = None,
    progress: Progress = silent,
) -> NDArray[np.float64]:
    """Compute distances of the joints that have bones, in ascending order, to target nodes."""
    if contraction is not None:
        known = graph, contraction, sources, bones, targets, nearest_joints, within, least
        return any_angle_paths(*known, progress)
    joints, rank = np.unique(bones.joint, return_inverse=True)
    owner = rank[sources.bone].astype(np.int32)
    # Sources of a joint are those of all its bones; if bones share a node, of the nearest one.
    order = np.lexsort((sources.distance, sources.node, owner))
    pairs = np.stack([owner, sources.node])[:, order]
    first = order[np.diff(pairs, prepend=-1).any(axis=0)]
    begin = Sources(sources.node[first], owner[first], sources.distance[first])
    return shortest_paths(graph, begin, len(joints), targets, progress)


def _reach_of_leaves(
    graph: CutCellGraph,
    contraction: Contraction | None,
    sources: Sources,
    bones: Bones,
    aimed: NDArray[np.bool_],
    progress: Progress,
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Compute the distances that `aim_leaf_bones` takes."""
    targets = nodes_on_mesh(graph)
    if contraction is None:
        every = joint_paths(graph, None, sources, bones, targets, progress=progress)
        return every[np.isin(np.unique(bones.joint), bones.joint[aimed])], every.min(axis=0)
    # Most of the body is in no leaf bone's region: there only the nearest joint matters.
    least = least_distances(graph, contraction, sources, bones, progress)
    leaves = sources.some(aimed), bones.some(aimed), targets, REGION_LEAVES, REGION_WITHIN
    reach = any_angle_paths(graph, contraction, *leaves, least, progress)
    return reach, least[contraction.number[targets]]


def _least(distance: NDArray[np.float64], bones: Bones) -> NDArray[np.float64]:
    """Reduce distances of bones (b, t) to those of the joints that have bones."""
    first = np.flatnonzero(np.diff(bones.joint, prepend=-1))
    return np.minimum.reduceat(distance, first, axis=0)


def _check_allowed(graph: CutCellGraph, skeleton: Skeleton, allowed: NDArray[np.bool_]) -> None:
    shape = (len(graph.vertex_node), len(skeleton.joints))
    if allowed.shape != shape:
        raise WeightsError(f"allowed has the shape {allowed.shape}, expected {shape}")
    bad = np.flatnonzero(~allowed[:, skeleton.deform].any(axis=1))
    if len(bad):
        raise WeightsError(
            f"vertex {bad[0]} may follow no joint that carries weight "
            f"({len(bad)} vertices are so); check which joints its skin lists"
        )
