"""How far every bone is from every vertex, through the body (paper section 3.2)."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from ..checks import check_integer
from ..errors import ParameterError, WeightsError
from ..graph import CutCellGraph
from ..progress import Progress, silent
from ..rig import Skeleton
from .any_angle import any_angle_paths
from .bones import Bones, Sources, bone_segments, find_sources
from .fallback import NOT_ALLOWED, REACHED, UNREACHED, UNUSED, straight_to_nearest
from .shortest_paths import shortest_paths


@dataclass(frozen=True, eq=False)
class BoneDistances:
    """Distances from bones and joints to the vertices of a mesh, in the unit cube.

    Parameters
    ----------
    joint : array, shape (j, n), float64
        The least over the bones of each joint; infinite where no path leads and for joints
        that may not carry weight. n counts the vertices of the mesh as it was given.
    bone : array, shape (b, n), float64
    bones : Bones
        In the unit cube.
    sources : Sources
        The nodes where paths begin.
    fallback : array, shape (n,), uint8
        0 for vertices reached through the body, else why not: an index into
        `geodesics.FALLBACK_REASONS`. These hold straight distances to a few bones.
    graph : CutCellGraph
    """

    joint: NDArray[np.float64]
    bone: NDArray[np.float64]
    bones: Bones
    sources: Sources
    fallback: NDArray[np.uint8]
    graph: CutCellGraph

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
        mine = np.flatnonzero(self.bones.joint[self.sources.bone] == joint)
        sources = Sources(
            self.sources.node[mine], np.zeros(len(mine), np.int32), self.sources.distance[mine]
        )
        everywhere = np.arange(len(self.graph.nodes), dtype=np.int32)
        if self.graph.connectivity != "any":
            return shortest_paths(self.graph, sources, 1, everywhere)[0]
        # Each bone is an anchor of its own.
        own = np.flatnonzero(self.bones.joint == joint)
        bones = Bones(self.bones.start[own], self.bones.end[own], self.bones.joint[own])
        sources = replace(sources, bone=(self.sources.bone[mine] - own[0]).astype(np.int32))
        return any_angle_paths(self.graph, sources, bones, everywhere).min(axis=0)


def bone_distances(
    graph: CutCellGraph,
    skeleton: Skeleton,
    *,
    samples: int = 5,
    leaf: str = "point",
    nearest: int = 3,
    allowed: NDArray[np.bool_] | None = None,
    progress: Progress = silent,
) -> BoneDistances:
    """Measure how far each bone is from each vertex along the graph.

    Parameters
    ----------
    graph : CutCellGraph
    skeleton : Skeleton
        In the units of the graph's mesh.
    samples : int
        N, points on each bone that look for their nearest node, 1 to 1000.
    leaf : {"point", "extend"}
        See `bone_segments`.
    nearest : int
        k, how many bones a vertex follows that none reaches, 1 or more.
    allowed : array, shape (n, j), bool, optional
        Which joints each vertex may follow; see `Rig.allowed`.
    progress : callable
        See `cutcell.progress`; the stage is called "distances".

    Returns
    -------
    BoneDistances

    Raises
    ------
    ParameterError
        A parameter is out of its range.
    MeshError
        The mesh has collapsed into points.
    WeightsError
        `allowed` has the wrong shape or leaves a vertex without any joint.

    References
    ----------
    Paper section 3.2, algorithm 2.
    """
    samples = check_integer("samples", samples, 1, 1000)
    nearest = check_integer("nearest", nearest, 1, 1_000_000)
    progress("distances", 0.0)
    bones = bone_segments(skeleton, leaf)
    bones = replace(
        bones, start=graph.lattice.to_unit(bones.start), end=graph.lattice.to_unit(bones.end)
    )
    may_follow = _allowed_bones(graph, skeleton, bones, allowed)
    sources = find_sources(graph, bones, samples)

    # Mesh vertices are the graph's first nodes; the file's own vertices share them.
    welded = int(graph.vertex_node.max()) + 1
    targets = np.arange(welded, dtype=np.int32)
    if graph.connectivity == "any":
        by_node = any_angle_paths(graph, sources, bones, targets, progress)
    else:
        by_node = shortest_paths(graph, sources, len(bones.joint), targets, progress)
    bone = by_node[:, graph.vertex_node]
    fallback = np.where(np.isfinite(bone).any(axis=0), REACHED, UNREACHED).astype(np.uint8)
    fallback[graph.degree[graph.vertex_node] == 0] = UNUSED
    if may_follow is not None:
        bone = np.where(may_follow.T, bone, np.inf)
        fallback[(fallback == REACHED) & ~np.isfinite(bone).any(axis=0)] = NOT_ALLOWED
    lost = np.flatnonzero(fallback != REACHED)
    if len(lost):
        bone[:, lost] = straight_to_nearest(
            graph.nodes[graph.vertex_node[lost]],
            bones,
            nearest,
            None if may_follow is None else may_follow[lost],
        )

    joint = np.full((len(skeleton.joints), bone.shape[1]), np.inf)
    first = np.flatnonzero(np.diff(bones.joint, prepend=-1))
    joint[bones.joint[first]] = np.minimum.reduceat(bone, first, axis=0)
    return BoneDistances(joint, bone, bones, sources, fallback, graph)


def _allowed_bones(
    graph: CutCellGraph, skeleton: Skeleton, bones: Bones, allowed: NDArray[np.bool_] | None
) -> NDArray[np.bool_] | None:
    """Turn joints allowed for each vertex into bones allowed, shape (n, b)."""
    if allowed is None:
        return None
    shape = (len(graph.vertex_node), len(skeleton.joints))
    if allowed.shape != shape:
        raise WeightsError(f"allowed has the shape {allowed.shape}, expected {shape}")
    by_bone = allowed[:, bones.joint]
    bad = np.flatnonzero(~by_bone.any(axis=1))
    if len(bad):
        raise WeightsError(
            f"vertex {bad[0]} may follow no joint that carries weight "
            f"({len(bad)} vertices are so); check which joints its skin lists"
        )
    return by_bone
