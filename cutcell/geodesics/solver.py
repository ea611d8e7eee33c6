"""A graph prepared for distances: its node grid, its contraction, and paths along it."""

from __future__ import annotations

from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from ..graph import CutCellGraph
from ..rig import Skeleton
from ..runtime.progress import Progress, silent
from ..runtime.threads import submit
from .any_angle.contraction import Contraction, contract
from .any_angle.theta_star import any_angle_paths, least_distances
from .bone_extents.fit import REGION_LEAVES, REGION_WITHIN, aim_leaf_bones, fit_bones
from .bones import Bones, Sources, bone_segments, find_sources, node_grid
from .nearest import NodeGrid
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
        Finds the nodes nearest to points.
    contraction : Contraction or None
        The graph with fewer nodes, with connectivity "any".
    targets : array, shape (k,), int32
        The welded vertices: the first nodes of the graph.
    """

    def __init__(self, graph: CutCellGraph) -> None:
        # Another thread contracts the graph while bones are fitted.
        self._contract = submit(lambda: contract(graph)) if graph.connectivity == "any" else None
        self.graph = graph
        self.grid: NodeGrid = node_grid(graph)
        self.targets = np.arange(graph.first_point, dtype=np.int32)

    @cached_property
    def contraction(self) -> Contraction | None:
        """The graph with fewer nodes, with connectivity "any"."""
        return self._contract() if self._contract else None

    def bones(
        self, skeleton: Skeleton, leaf: str, allowed: NDArray[np.bool_] | None = None
    ) -> tuple[Bones, NDArray[np.bool_]]:
        """Place bones in the unit cube; also return which leaf bones are yet to be aimed, (b,).

        Shapes: allowed (n, j), see `Rig.allowed`.
        """
        if leaf == "fit":
            return fit_bones(self.graph, skeleton, self.grid, allowed)
        bones, to_unit = bone_segments(skeleton, leaf), self.graph.lattice.to_unit
        bones = Bones(to_unit(bones.start), to_unit(bones.end), bones.joint)
        return bones, np.zeros(len(bones.joint), np.bool_)

    def sources(self, bones: Bones, samples: int) -> Sources:
        """Find the nodes where the distances of bones begin."""
        return find_sources(self.graph, bones, samples, self.grid, self.contraction)

    def aim(
        self,
        bones: Bones,
        sources: Sources,
        aimed: NDArray[np.bool_],
        samples: int,
        progress: Progress = silent,
    ) -> tuple[Bones, Sources]:
        """Aim leaf bones, `aimed` (b,), at the middle of their skin; find their sources again."""
        if not aimed.any():
            return bones, sources
        bones = aim_leaf_bones(
            self.graph, bones, aimed, *self._reach(bones, sources, aimed, progress)
        )
        return bones, sources.replaced(aimed, self.sources(bones.subset(aimed), samples))

    def _reach(
        self, bones: Bones, sources: Sources, aimed: NDArray[np.bool_], progress: Progress
    ) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Compute the distances that `aim_leaf_bones` takes."""
        if self.contraction is None:
            every = self.paths(bones, sources, progress=progress)
            return every[np.isin(np.unique(bones.joint), bones.joint[aimed])], every.min(axis=0)
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
    ) -> NDArray[np.float64]:
        """Compute the distances of the joints that have bones, ascending, to targets: (j, t)."""
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
        return shortest_paths(self.graph, of_joints, len(joints), targets, progress)
