"""Whether straight segments stay inside the body."""

from __future__ import annotations

from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from ...animation.any_angle.contraction import Contraction
from ...graph import CutCellGraph
from ...graph.inside_edges import cells_inside

SAMPLE_SPACING = 0.5
"""Lattice cells between samples of a segment."""
BESIDE = 0.2
"""Lattice cells: a sample is also taken as inside if a point this far from it along an axis is, so
that segments may run along the surface."""
SAMPLED_TOLERANCE = SAMPLE_SPACING / 2 + BESIDE
"""Lattice cells: no point of a segment whose samples are all inside is farther from the body."""
_STEPS = BESIDE * np.concatenate([np.eye(3), -np.eye(3)])


class Inside:
    """Test by winding number for points and segments inside the body, or `SAMPLED_TOLERANCE` off.

    Parameters
    ----------
    graph : CutCellGraph
    contraction : Contraction or None
        Of the graph. Where the mesh is closed, its lattice steps spare most points their winding
        number: those in a lattice cell whose twelve edges lie inside.
    """

    def __init__(self, graph: CutCellGraph, contraction: Contraction | None) -> None:
        self._graph, self._contraction = graph, contraction

    def points(self, points: NDArray[np.float64]) -> NDArray[np.bool_]:
        """Return which points (q, 3) of the unit cube are inside or beside it, shape (q,)."""
        inside = self._in_whole_cell(points)
        for steps in (np.zeros((1, 3)), _STEPS / self._graph.lattice.resolution):
            rest = np.flatnonzero(~inside)
            if len(rest):
                around = (points[rest, None] + steps).reshape(-1, 3)
                number = self._graph.winding_numbers.at(around).reshape(len(rest), -1)
                inside[rest] = (number >= self._graph.winding_threshold).any(axis=1)
        return inside

    def segments(
        self, start: NDArray[np.float64], end: NDArray[np.float64]
    ) -> list[NDArray[np.bool_]]:
        """Sample segments between points (s, 3); tell for each which of its samples are inside.

        The k-th of m samples represents the k-th of m equal parts of the segment.
        """
        cells = np.linalg.norm(end - start, axis=1) * self._graph.lattice.resolution
        counts = np.maximum(np.ceil(cells / SAMPLE_SPACING).astype(int), 1)
        stop = np.cumsum(counts)
        number = np.arange(stop[-1]) - np.repeat(stop - counts, counts)
        share = (number + 0.5) / np.repeat(counts, counts)
        points = np.repeat(start, counts, axis=0)
        points += share[:, None] * np.repeat(end - start, counts, axis=0)
        return np.split(self.points(points), stop[:-1])

    @cached_property
    def _cells(self) -> NDArray[np.int64]:
        """The cells whose twelve edges lie inside, numbered as by `_number`, ascending."""
        # Where a mesh is open, the winding number may sink below tau between edges inside.
        if self._contraction is None or not self._graph.is_closed:
            return np.empty(0, np.int64)
        graph = self._graph
        corners = graph.nodes[graph.first_point : graph.first_surface]
        lowest = corners[cells_inside(self._contraction.steps)]
        resolution = graph.lattice.resolution
        return np.sort(_number(np.rint(lowest * resolution - 0.5), resolution))

    def _in_whole_cell(self, points: NDArray[np.float64]) -> NDArray[np.bool_]:
        resolution = self._graph.lattice.resolution
        lowest = np.floor(points * resolution - 0.5)
        number = _number(np.clip(lowest, 0, resolution - 1), resolution)
        is_in = (lowest >= 0).all(axis=1) & (lowest < resolution).all(axis=1)
        if not len(self._cells):
            return np.zeros(len(points), np.bool_)
        at = np.minimum(np.searchsorted(self._cells, number), len(self._cells) - 1)
        in_cell: NDArray[np.bool_] = is_in & (self._cells[at] == number)
        return in_cell


def _number(corner: NDArray[np.float64], resolution: int) -> NDArray[np.int64]:
    x, y, z = corner.T.astype(np.int64)
    number: NDArray[np.int64] = (x * resolution + y) * resolution + z
    return number
