"""Weights spread over the skin, as far as the skin is away from its bone."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..compiled import compiled
from ..progress import Shares, Tell
from ..threads import in_threads, parts, watched
from .elimination import LANES, Factors, factorise, substitute
from .skin import Skin

SHARPNESS = 3.0
"""c: weights spread over about 1 / sqrt(c) of the distance from skin to bone."""
LEAST_CELLS = 0.25
"""Lattice cells; skin on a bone itself would not let go of its weights at all."""


@dataclass(frozen=True, eq=False)
class Diffusion:
    """The equilibrium of weights that the skin conducts and its bones hold on to.

        (L + M H) w = M H p,    H = c / depth²

    Without the right side's p being spread already, this is bone heat. Each joint of the
    skeleton bends the skin over a stretch about as long as the limb is thick there.

    Parameters
    ----------
    hold : array, shape (k,)
        The diagonal of M H.
    factors : Factors
        Of the matrix, with rows and columns in the order of elimination.
    order : array, shape (k,), int32
        Which place is at each of those.

    References
    ----------
    Baran & Popović 2007, "Automatic rigging and animation of 3D characters", section 4.
    """

    hold: NDArray[np.float64]
    factors: Factors
    order: NDArray[np.int32]

    @classmethod
    def over(
        cls,
        skin: Skin,
        depth: NDArray[np.float64],
        resolution: int,
        tell: Tell = lambda done: None,
    ) -> Diffusion:
        """Prepare the equation.

        Parameters
        ----------
        skin : Skin
            Of k places.
        depth : array, shape (k,)
            Distance to the nearest bone through the body, in the unit cube.
        resolution : int
            R, of the lattice that distances were measured on.
        tell : callable
            See `progress.Tell`.
        """
        depth = np.maximum(depth, LEAST_CELLS / resolution)
        # A place without area conducts nothing; any positive number lets it keep its own weights.
        hold = np.maximum(skin.areas, 1e-12) * SHARPNESS / depth**2
        start, column, value = skin.stiffness
        diagonal = value[start[:-1]] + hold
        matrix = start, column, value, diagonal
        factors = watched(lambda pace: factorise(*matrix, skin.order, pace), len(hold), tell)
        return cls(hold, factors, skin.order)

    def spread(
        self, weights: NDArray[np.float64], tell: Tell = lambda done: None
    ) -> NDArray[np.float64]:
        """Return the equilibrium of weights p, shape (k, j); rows sum to one before and after."""
        used = np.flatnonzero(weights.max(axis=0))
        spread = np.zeros_like(weights)
        groups = [used[first : first + LANES] for first in range(0, len(used), LANES)]
        shares = Shares(lambda stage, done: tell(done), "weights", len(groups))

        def solve(group: int) -> None:
            known = *self.factors, self.order, self.hold, weights, groups[group], spread
            watched(
                lambda pace: _solve(*known, pace),
                2 * len(self.hold),
                lambda done: shares.tell(group, done),
            )
            shares.tell(group, 1.0)

        def normalise(part: slice) -> None:
            total = spread[part].sum(axis=1, keepdims=True)
            # Next to needles rounding leaves nothing: such places keep their own weights.
            known = np.isfinite(total) & (total > 0)
            if known.all():
                spread[part] /= total
            else:
                own = weights[part].copy()
                spread[part] = np.divide(spread[part], total, out=own, where=known)

        in_threads(solve, range(len(groups)))
        in_threads(normalise, parts(len(spread)), lambda done: tell(1.0))
        return spread


@compiled
def _solve(begin, rows, values, pivots, order, hold, weights, joints, spread, pace):
    """Put the equilibrium of some joints' weights into `spread`; see `substitute` for `pace`."""
    right = np.zeros((len(order), LANES))
    for k in range(len(order)):
        v = order[k]
        for lane in range(len(joints)):
            right[k, lane] = hold[v] * weights[v, joints[lane]]
    substitute(begin, rows, values, pivots, right, pace)
    for k in range(len(order)):
        for lane in range(len(joints)):
            spread[order[k], joints[lane]] = max(right[k, lane], 0.0)
