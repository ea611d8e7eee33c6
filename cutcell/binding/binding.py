"""The record of a binding."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array

from ..geodesics import BoneDistances
from ..graph import CutCellGraph
from ..method import Method
from ..pose.stretch import Stretch, measure_stretch
from ..runtime.repr import Summarized


@dataclass(frozen=True, eq=False, repr=False)
class Binding(Summarized):
    """A bound rig: weights, and everything they came from.

    Parameters
    ----------
    rows : csr_array, shape (n, j)
        Weights of the rig's own vertices, in their order.
    graph : CutCellGraph
    distances : BoneDistances
        Distances from as many of each vertex's nearest joints as the falloff needs.
    seconds : dict of str to float
        Time taken by each stage: "graph", "distances", "weights".
    warnings : tuple of str
        User-facing warnings.
    method : Method
        The method of the weights.

    Attributes
    ----------
    weights : array, shape (n, j), float64
        `rows` as an array, made when it is first used.
    stretch : Stretch
        How much of the surface stretches as joints turn, and where.
    """

    rows: csr_array
    graph: CutCellGraph
    distances: BoneDistances
    seconds: dict[str, float]
    warnings: tuple[str, ...]
    method: Method

    @cached_property
    def weights(self) -> NDArray[np.float64]:
        """`rows` as an array, made when it is first used."""
        return self.rows.toarray()

    @cached_property
    def stretch(self) -> Stretch:
        """How much of the surface stretches as joints turn, and where."""
        skeleton = self.distances.skeleton
        assert skeleton is not None
        return measure_stretch(self.graph, skeleton, self.rows)

    @property
    def _summary(self) -> dict[str, Any]:
        vertices, joints = self.rows.shape
        return {
            "method": self.method.name,
            "resolution": self.method.resolution,
            "vertices": vertices,
            "joints": joints,
            "nodes": len(self.graph.nodes),
            "edges": len(self.graph.edges),
            "unreached_vertices": int(np.count_nonzero(self.distances.fallback)),
            "seconds": round(sum(self.seconds.values()), 2),
            "warnings": len(self.warnings),
        }
