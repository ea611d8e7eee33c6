"""Distances along one graph: bones and sources, then shortest paths (paper, algorithm 2)."""

from __future__ import annotations

from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array

from ..animation.any_angle.contraction import Contraction, contract
from ..animation.any_angle.theta_star import any_angle_paths, least_distances
from ..animation.bone_extents.fit import REGION_LEAVES, REGION_WITHIN, aim_leaf_bones, fit_bones
from ..bones.bones import Bones, Sources, bone_samples, bone_segments
from ..bones.nearest import NodeGrid
from ..geometry.segments import distance_to_segment
from ..graph import CutCellGraph
from ..method import Method
from ..rig import Skeleton
from ..rig.rows import from_dense, least
from ..runtime.progress import Progress, silent
from ..runtime.threads import submit
from .shortest_paths import shortest_paths


class BoneDistanceSolver:
    """Computes distances from bones along one graph, for any number of skeletons.

    Parameters
    ----------
    graph : CutCellGraph

    Attributes
    ----------
    graph : CutCellGraph
    grid : NodeGrid
        Finds the nodes with edges that are nearest to points.
    contraction : Contraction or None
        The graph with fewer nodes, with connectivity "any".
    targets : array, shape (k,), int32
        The welded vertices: the first nodes of the graph.
    """

    def __init__(self, graph: CutCellGraph) -> None:
        # Another thread contracts the graph while bones are fitted.
        self._contract = submit(lambda: contract(graph)) if graph.connectivity == "any" else None
        self.graph = graph
        self.grid = NodeGrid.of(graph)
        self.targets = np.arange(graph.first_point, dtype=np.int32)

    def __reduce__(self) -> tuple[Any, ...]:
        """Pickle the graph alone: all else is computed from it, some by another thread."""
        return BoneDistanceSolver, (self.graph,)

    @cached_property
    def contraction(self) -> Contraction | None:
        """The graph with fewer nodes, with connectivity "any"."""
        return self._contract() if self._contract else None

    def place(
        self,
        skeleton: Skeleton,
        method: Method,
        allowed: NDArray[np.bool_] | None = None,
        progress: Progress = silent,
    ) -> tuple[Bones, Sources]:
        """Place bones in the unit cube, and find the nodes where their distances begin.

        Shapes: allowed (n, j), see `Rig.allowed`.
        """
        bones, aimed = self.bones(skeleton, method.leaf, allowed)
        sources = self.sources(bones, method.samples)
        if aimed.any():  # these leaf bones end in the middle of the skin that is nearest to them
            distance, nearest = self._leaf_distances(bones, sources, aimed, progress)
            bones = aim_leaf_bones(self.graph, bones, aimed, distance, nearest)
            sources = sources.replaced(aimed, self.sources(bones.subset(aimed), method.samples))
        return bones, sources

    def bones(
        self, skeleton: Skeleton, leaf: str, allowed: NDArray[np.bool_] | None = None
    ) -> tuple[Bones, NDArray[np.bool_]]:
        """Return bones in the unit cube, and (b,) whether `place` aims each at its skin."""
        if leaf == "fit":
            return fit_bones(self.graph, skeleton, self.grid, allowed)
        bones, to_unit = bone_segments(skeleton, leaf), self.graph.lattice.to_unit
        bones = Bones(to_unit(bones.start), to_unit(bones.end), bones.joint)
        return bones, np.zeros(len(bones.joint), np.bool_)

    def sources(self, bones: Bones, samples: int) -> Sources:
        """Find the nodes where the distances of bones begin."""
        return find_sources(self.graph, bones, samples, self.grid, self.contraction)

    def _leaf_distances(
        self, bones: Bones, sources: Sources, aimed: NDArray[np.bool_], progress: Progress
    ) -> tuple[csr_array, NDArray[np.float64]]:
        """Compute distances of joints with aimed bones (k, t), and of the nearest joint (k,)."""
        if self.contraction is None:
            every = self.paths(bones, sources, progress=progress)
            return every[:, np.isin(np.unique(bones.joint), bones.joint[aimed])], least(every)
        # Most of the body is in no leaf bone's region: there only the nearest joint matters.
        nearest = self.nearest_distance(bones, sources, progress)
        assert nearest is not None
        reach = self.paths(
            bones.subset(aimed),
            sources.subset(aimed),
            REGION_LEAVES,
            REGION_WITHIN,
            nearest,
            progress,
        )
        return reach, nearest[self.contraction.number[self.targets]]

    def nearest_distance(
        self, bones: Bones, sources: Sources, progress: Progress = silent
    ) -> NDArray[np.float64] | None:
        """Compute the distance of the nearest joint to each contracted node; None along edges."""
        if self.contraction is None:
            return None
        return least_distances(self.graph, self.contraction, sources, bones, progress)

    def paths(
        self,
        bones: Bones,
        sources: Sources,
        nearest_joints: int | None = None,
        within: float = np.inf,
        nearest_distance: NDArray[np.float64] | None = None,
        progress: Progress = silent,
        targets: NDArray[np.int32] | None = None,
    ) -> csr_array:
        """Compute the distances of the joints that have bones, ascending, to targets: (t, j)."""
        targets = self.targets if targets is None else targets
        if self.contraction is not None:
            return any_angle_paths(
                self.graph, self.contraction, sources, bones, targets,
                nearest_joints, within, nearest_distance, progress,
            )  # fmt: skip
        joints, rank = np.unique(bones.joint, return_inverse=True)
        owner = rank[sources.bone].astype(np.int32)
        # Sources of a joint are those of all its bones; if bones share a node, of the nearest one.
        order = np.lexsort((sources.distance, sources.node, owner))
        pairs = np.stack([owner, sources.node])[:, order]
        first = order[np.diff(pairs, prepend=-1).any(axis=0)]
        of_joints = Sources(sources.node[first], owner[first], sources.distance[first])
        return from_dense(shortest_paths(self.graph, of_joints, len(joints), targets, progress).T)


def find_sources(
    graph: CutCellGraph,
    bones: Bones,
    samples: int,
    grid: NodeGrid,
    contraction: Contraction | None = None,
) -> Sources:
    """Find the nodes nearest to evenly spaced points on each bone (paper, algorithm 2).

    In a contracted graph, sources are the representatives of the nearest nodes.
    """
    points, bone = bone_samples(graph, bones, samples)
    point, nearest = grid.nearest(points)
    node = nearest if contraction is None else contraction.representative(nearest)
    pairs = np.unique(bone[point] * len(graph.nodes) + node)
    of, begin = (x.astype(np.int32) for x in np.divmod(pairs, len(graph.nodes)))
    straight = distance_to_segment(graph.nodes[begin], bones.start[of], bones.end[of])
    return Sources(begin, of, straight)
