"""Bone heat on the surface: weights in equilibrium between conduction and the bones' pull."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array

from ...geometry.counting_sort import spatial_order
from ...runtime.compiled import compiled
from ...runtime.progress import Shares, Tell
from ...runtime.threads import in_threads, parts, watched
from .lanes import RIGHT_SIDES
from .ldl import Factors, factorise, substitute
from .multigrid import Multigrid
from .surface_operators import SurfaceOperators

SHARPNESS = 3.0
"""c: weights spread over about 1 / sqrt(c) of the distance from surface to bone."""
MIN_CELLS = 0.25
"""Lattice cells: a vertex on a bone itself would keep its weights whatever is around it."""


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
    solver : Factors or Multigrid
        Of the matrix. Up to `surface_operators.MANY` welded vertices factors, which are exact;
        beyond, multigrid, within 1e-3.
    order : array, shape (k,), int32 or int64
        In which its rows and columns are: the fill-reducing ordering of factors, for multigrid
        ordered by place.

    References
    ----------
    Baran & Popović 2007, "Automatic rigging and animation of 3D characters", section 4.
    """

    screening: NDArray[np.float64]
    solver: Factors | Multigrid
    order: NDArray[np.integer]

    @classmethod
    def over(
        cls,
        surface: SurfaceOperators,
        depth: NDArray[np.float64],
        resolution: int,
        tell: Tell = lambda done: None,
    ) -> Diffusion:
        """Factorise the equation's matrix.

        Shapes: depth (k,).
        """
        depth = np.maximum(depth, MIN_CELLS / resolution)
        # A vertex without area conducts nothing; any positive number makes it keep its own weights.
        screening = np.maximum(surface.areas, 1e-12) * SHARPNESS / depth**2
        start, column, value = surface.stiffness
        if surface.order is None:
            value = value.copy()
            value[start[:-1]] += screening
            matrix = csr_array((value, column, start), (len(screening),) * 2)
            order = spatial_order(surface.points)
            return cls(screening, Multigrid.of(matrix[order][:, order]), order)
        known = *surface.stiffness, value[start[:-1]] + screening, surface.order
        factors = watched(lambda pace: factorise(*known, pace), len(screening), tell)
        return cls(screening, factors, surface.order)

    def spread(
        self, weights: NDArray[np.float64], tell: Tell = lambda done: None
    ) -> NDArray[np.float64]:
        """Return the equilibrium of weights p, shape (k, j); rows sum to one before and after."""
        spread = self.equilibrium(weights, tell)
        self.normalise(spread, weights)
        tell(1.0)
        return spread

    def normalise(self, spread: NDArray[np.float64], weights: NDArray[np.float64]) -> None:
        """Let the rows of an equilibrium of weights sum to one, in place."""

        def normalise(part: slice) -> None:
            total = spread[part].sum(axis=1, keepdims=True)
            # Next to needle triangles rounding may leave nothing: keep the vertex' own weights.
            known = np.isfinite(total) & (total > 0)
            if known.all():
                spread[part] /= total
            else:
                own = weights[part].copy()
                spread[part] = np.divide(spread[part], total, out=own, where=known)

        in_threads(normalise, parts(len(spread)))

    def equilibrium(
        self, weights: NDArray[np.float64], tell: Tell = lambda done: None
    ) -> NDArray[np.float64]:
        """Return the equilibrium, where rounding leaves rows that do not quite sum to one."""
        spread = np.zeros(weights.shape)
        self.solve(weights, np.flatnonzero(weights.max(axis=0)), spread, tell)
        return spread

    def solve(
        self,
        weights: NDArray[np.float64],
        joints: NDArray[np.intp],
        spread: NDArray[np.float64],
        tell: Tell = lambda done: None,
    ) -> None:
        """Write the equilibrium of some joints' weights into their columns, zeros before."""
        groups = [joints[i : i + RIGHT_SIDES] for i in range(0, len(joints), RIGHT_SIDES)]
        shares = Shares(lambda stage, done: tell(done), "weights", len(groups))

        def solve(group: int) -> None:
            self._solve(groups[group], weights, spread, lambda done: shares.tell(group, done))
            shares.tell(group, 1.0)

        in_threads(solve, range(len(groups)))

    def _solve(
        self,
        joints: NDArray[np.intp],
        weights: NDArray[np.float64],
        spread: NDArray[np.float64],
        tell: Tell,
    ) -> None:
        """Solve for the weights of at most `RIGHT_SIDES` joints, into `spread`."""
        if isinstance(self.solver, Multigrid):
            right = _right_sides(self.order, self.screening, weights, joints)
            rows, solution = self.solver.solve(right, tell)
            found = np.maximum(solution[:, : len(joints)], 0.0)
            spread[self.order[rows][:, None], joints] = found
        else:
            known = *self.solver, self.order, self.screening, weights, joints, spread
            watched(lambda pace: _solve(*known, pace), 2 * len(weights), tell)


@compiled
def _solve(begin, rows, values, pivots, order, screening, weights, joints, spread, pace):
    """Solve for the weights of some joints, into `spread`; see `substitute` for `pace`."""
    right = _right_sides(order, screening, weights, joints)
    substitute(begin, rows, values, pivots, right, pace)
    for k in range(len(order)):
        for i in range(len(joints)):
            spread[order[k], joints[i]] = max(right[k, i], 0.0)


@compiled
def _right_sides(order, screening, weights, joints):
    """Return the right sides, shape (k, RIGHT_SIDES), of the equations of some joints' weights."""
    right = np.zeros((len(order), RIGHT_SIDES))
    for k in range(len(order)):
        v = order[k]
        for i in range(len(joints)):
            right[k, i] = screening[v] * weights[v, joints[i]]
    return right
