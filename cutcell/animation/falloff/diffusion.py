"""Bone heat on the surface: weights in equilibrium between conduction and the pull of bones."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array

from ...geometry.welded import WeldedMesh
from ...rig.rows import rows_of_entries, scaled, with_rows
from ...runtime.compiled import compiled
from ...runtime.progress import Tell
from ...runtime.threads import in_threads
from .factors import LANES, Factors

SHARPNESS = 2.5
"""c: weights spread over about 1 / sqrt(c) of the distance from surface to bone."""
MIN_DEPTH_CELLS = 0.25
"""Lattice cells: a vertex on a bone itself would keep its weights whatever is around it."""
MIN_SCREENING = 1e-12
"""Minimum part of the matrix's diagonal: less would be rounded away and leave it singular."""
NEGLIGIBLE_WEIGHT = 1e-7
"""Weights below it are not computed. They decay like exp(-sqrt(c) s / depth): a joint's weights end
ten depths from its share."""
MIN_SHARE = 1e-9
"""Shares of the surface below it pull at nothing: they would make a joint's support larger."""


@dataclass(frozen=True, eq=False)
class Diffusion:
    """The screened Poisson equation of bone heat.

        (L + M H) w = M H p,    H = c / depth²

    The right side p is the surface as it was divided among the joints by distance. Each joint
    then bends the surface over a stretch about as long as the limb is thick there. Each is solved
    for where its weights are not `NEGLIGIBLE_WEIGHT`.

    Parameters
    ----------
    screening : array, shape (k,)
        The diagonal of M H.
    factors : Factors
        Of the matrix.

    References
    ----------
    Baran & Popović 2007, "Automatic rigging and animation of 3D characters", section 4.
    """

    screening: NDArray[np.float64]
    factors: Factors

    @classmethod
    def over(cls, surface: WeldedMesh, depth: NDArray[np.float64], resolution: int) -> Diffusion:
        """Factorise the equation's matrix: depth (k,)."""
        depth = np.maximum(depth, MIN_DEPTH_CELLS / resolution)
        # A vertex without area conducts nothing; any positive number makes it keep its own weights.
        screening = np.maximum(surface.areas, 1e-12) * SHARPNESS / depth**2
        start, column, value = surface.stiffness
        screening = np.maximum(screening, MIN_SCREENING * value[start[:-1]])
        value = value.copy()
        value[start[:-1]] += screening
        rows = start, column, value
        return cls(screening, Factors.of(surface.dissection, rows, MIN_SCREENING))

    def spread(self, weights: csr_array, report: Tell = lambda done: None) -> csr_array:
        """Return the equilibrium of weights p, shape (k, j); rows sum to one before and after."""
        return self.whole(self.equilibrium(weights, report), weights)

    def whole(self, equilibrium: csr_array, weights: csr_array) -> csr_array:
        """Return the equilibrium of weights with its rows scaled to sum to one."""
        total = equilibrium.sum(axis=1)
        # Next to needle triangles rounding may leave nothing: the vertex keeps its own weights.
        lost = np.flatnonzero(~(np.isfinite(total) & (total > 0)))
        if len(lost):
            equilibrium, total[lost] = with_rows(equilibrium, lost, weights[lost]), 1
        return scaled(equilibrium, 1 / total)

    def equilibrium(self, weights: csr_array, report: Tell = lambda done: None) -> csr_array:
        """Solve for weights (k, j), those of some joints or all; rows do not quite sum to one."""
        joints = weights.shape[1]
        pulling = np.flatnonzero(weights.data >= MIN_SHARE)
        row, joint = rows_of_entries(weights)[pulling], weights.indices[pulling]
        # Joints whose weights are near to each other share most of the work.
        count = np.bincount(joint, minlength=joints)
        place = np.bincount(joint, self.factors.blocks.position[row], joints)
        middle = np.where(count > 0, place / np.maximum(count, 1), np.inf)
        order = np.argsort(middle, kind="stable")
        rank = np.empty(joints, np.int32)
        rank[order] = np.arange(joints, dtype=np.int32)
        by_rank = np.argsort(rank[joint], kind="stable")
        row, rank = row[by_rank], rank[joint][by_rank]
        right = self.screening[row] * weights.data[pulling][by_rank]

        def solve(first: int) -> tuple[NDArray, ...]:
            part = slice(*np.searchsorted(rank, (first, first + LANES)))
            vertex, lane, value = self.factors.solve(
                row[part], rank[part] - first, right[part], NEGLIGIBLE_WEIGHT
            )
            return vertex, lane, value, order[first : first + LANES]

        solved = in_threads(solve, range(0, np.count_nonzero(count), LANES), report)
        return _as_rows(solved, weights.shape)


def _as_rows(solved: list[tuple[NDArray, ...]], shape: tuple[int, int]) -> csr_array:
    """Return entries as rows, and empty the list: of a large mesh they take much memory."""
    start = np.zeros(shape[0] + 1, np.int64)
    for vertex, *_ in solved:
        start[1:] += np.bincount(vertex, minlength=shape[0])
    start = np.cumsum(start)
    column, data, end = np.empty(start[-1], np.int32), np.empty(start[-1]), start[:-1].copy()
    while solved:
        _write(*solved.pop(), end, column, data)
    rows = csr_array((data, column, start), shape)
    rows.sort_indices()
    return rows


@compiled
def _write(vertex, lane, value, joints, end, column, data):
    """Append entries to their rows, which end at `end` so far."""
    for k in range(len(vertex)):
        v = vertex[k]
        column[end[v]], data[end[v]] = joints[lane[k]], value[k]
        end[v] += 1
