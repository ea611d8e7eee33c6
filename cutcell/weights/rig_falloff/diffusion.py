"""Bone heat on the surface: weights in equilibrium between conduction and the pull of bones."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array
from scipy.sparse.linalg import SuperLU

from ...geometry.counting_sort import spatial_order
from ...runtime.progress import Shares, Tell
from ...runtime.threads import in_threads, parts
from .multigrid import MANY, RIGHT_SIDES, Multigrid, factorise
from .surface_operators import SurfaceOperators

SHARPNESS = 2.5
"""c: weights spread over about 1 / sqrt(c) of the distance from surface to bone."""
MIN_CELLS = 0.25
"""Lattice cells: a vertex on a bone itself would keep its weights whatever is around it."""
MIN_SCREENING = 1e-12
"""Of the matrix's diagonal: less would be lost to rounding, and leave the matrix singular."""


@dataclass(frozen=True, eq=False)
class Diffusion:
    """The screened Poisson equation of bone heat.

        (L + M H) w = M H p,    H = c / depth²

    The right side p is the surface as it was divided among the joints by distance. Each joint
    then bends the surface over a stretch about as long as the limb is thick there.

    Parameters
    ----------
    screening : array, shape (k,)
        The diagonal of M H.
    solver : SuperLU or Multigrid
        Of the matrix. Up to `MANY` welded vertices factors, which are exact; beyond, multigrid,
        within 1e-3.
    order : array, shape (k,), or None
        In which the rows and columns of multigrid are: by place.

    References
    ----------
    Baran & Popović 2007, "Automatic rigging and animation of 3D characters", section 4.
    """

    screening: NDArray[np.float64]
    solver: SuperLU | Multigrid
    order: NDArray[np.intp] | None = None

    @classmethod
    def over(
        cls, surface: SurfaceOperators, depth: NDArray[np.float64], resolution: int
    ) -> Diffusion:
        """Factorise the equation's matrix: depth (k,)."""
        depth = np.maximum(depth, MIN_CELLS / resolution)
        # A vertex without area conducts nothing; any positive number makes it keep its own weights.
        screening = np.maximum(surface.areas, 1e-12) * SHARPNESS / depth**2
        start, column, value = surface.stiffness
        value, diagonal = value.copy(), start[:-1]
        screening = np.maximum(screening, MIN_SCREENING * value[diagonal])
        value[diagonal] += screening
        matrix = csr_array((value, column, start), (len(screening),) * 2)
        if len(screening) <= MANY:
            return cls(screening, factorise(matrix))
        order = spatial_order(surface.points)
        return cls(screening, Multigrid.of(matrix[order][:, order]), order)

    def spread(
        self, weights: NDArray[np.float64], report: Tell = lambda done: None
    ) -> NDArray[np.float64]:
        """Return the equilibrium of weights p, shape (k, j); rows sum to one before and after."""
        spread = self.equilibrium(weights, report)
        self.normalise(spread, weights)
        report(1.0)
        return spread

    def normalise(self, spread: NDArray[np.float64], weights: NDArray[np.float64]) -> None:
        """Let the rows of an equilibrium of weights sum to one, in place."""

        def normalise(part: slice) -> None:
            total = spread[part].sum(axis=1, keepdims=True)
            # Next to needle triangles rounding may leave nothing: the vertex keeps its own weights.
            is_positive = np.isfinite(total) & (total > 0)
            if is_positive.all():
                spread[part] /= total
            else:
                normalised = weights[part].copy()
                spread[part] = np.divide(spread[part], total, out=normalised, where=is_positive)

        in_threads(normalise, parts(len(spread)))

    def equilibrium(
        self, weights: NDArray[np.float64], report: Tell = lambda done: None
    ) -> NDArray[np.float64]:
        """Return the equilibrium, where rounding leaves rows that do not quite sum to one."""
        spread = np.zeros(weights.shape)
        self.solve(weights, np.flatnonzero(weights.max(axis=0)), spread, report)
        return spread

    def solve(
        self,
        weights: NDArray[np.float64],
        joints: NDArray[np.intp],
        spread: NDArray[np.float64],
        report: Tell = lambda done: None,
    ) -> None:
        """Write the equilibrium of the weights of some joints into their columns, zeros before."""
        groups = [joints[i : i + RIGHT_SIDES] for i in range(0, len(joints), RIGHT_SIDES)]
        shares = Shares(lambda stage, done: report(done), "weights", len(groups))

        def solve(group: int) -> None:
            self._solve(groups[group], weights, spread, lambda done: shares.tell(group, done))
            shares.tell(group, 1.0)

        in_threads(solve, range(len(groups)))

    def _solve(
        self,
        joints: NDArray[np.intp],
        weights: NDArray[np.float64],
        spread: NDArray[np.float64],
        report: Tell,
    ) -> None:
        """Solve for the weights of at most `RIGHT_SIDES` joints, into `spread`."""
        right = self.screening[:, None] * weights[:, joints]
        if self.order is None or isinstance(self.solver, SuperLU):
            spread[:, joints] = np.maximum(self.solver.solve(right), 0.0)
            return
        padded = np.zeros((len(weights), RIGHT_SIDES))
        padded[:, : len(joints)] = right[self.order]
        rows, solution = self.solver.solve(padded, report)
        spread[self.order[rows][:, None], joints] = np.maximum(solution[:, : len(joints)], 0.0)
