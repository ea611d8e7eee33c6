"""Adjustments of the falloff by a person, as arrays."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray


@dataclass(frozen=True, eq=False)
class Adjustments:
    """Adjustments of the falloff.

    Parameters
    ----------
    gain : array, shape (j,)
        Distances of each joint are divided by this; 1 for most.
    radius : array, shape (j,)
        Radius of the surface about each joint's bones, in the unit cube; NaN where it is measured.
    independent : array, shape (c,), integers
        Welded vertices whose connected components are never rigid.
    """

    gain: NDArray[np.float64]
    radius: NDArray[np.float64]
    independent: NDArray[np.integer]
