"""Bone heat on the surface: weights in equilibrium between conduction and the pull of bones."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csc_array, csr_array

from ...rig.rows import scaled, with_data, with_rows
from ...runtime.progress import Tell
from ...runtime.threads import in_threads
from .factors import LANES, Factors
from .surface_operators import SurfaceOperators

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
    def over(
        cls, surface: SurfaceOperators, depth: NDArray[np.float64], resolution: int
    ) -> Diffusion:
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
        is_pulling = weights.data >= MIN_SHARE
        if not is_pulling.any():
            return csr_array(weights.shape)
        columns = csc_array(with_data(weights, weights.data * is_pulling))
        count = np.diff(columns.indptr)
        joints = np.flatnonzero(count)
        # Joints whose weights are near to each other share most of the work.
        place = self.factors.blocks.position[columns.indices].astype(np.float64)
        middle = np.add.reduceat(place, columns.indptr[joints]) / count[joints]
        joints = joints[np.argsort(middle, kind="stable")]

        def solve(group: NDArray[np.intp]) -> tuple[NDArray, NDArray, NDArray]:
            part = columns[:, group]
            lane = np.repeat(np.arange(len(group)), np.diff(part.indptr))
            right = self.screening[part.indices] * part.data
            row, lane, value = self.factors.solve(part.indices, lane, right, NEGLIGIBLE_WEIGHT)
            return row, group[lane], value

        groups = [joints[i : i + LANES] for i in range(0, len(joints), LANES)]
        solved = in_threads(solve, groups, report)
        row, joint, value = (np.concatenate(entries) for entries in zip(*solved, strict=True))
        equilibrium = csr_array((value, (row, joint)), weights.shape)
        equilibrium.sort_indices()
        return equilibrium
