"""libigl's fast winding number, for comparison.

It is a truncated series: segments whose number is within about 1e-2 of tau may be decided
otherwise.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ..ray_tracers import optional_library
from ..surface import Surface


def fast_winding_numbers(surface: Surface, points: NDArray[np.float64]) -> NDArray[np.float64]:
    """Approximate the winding number at points (k, 3).

    References
    ----------
    Barill, Dickson, Schmidt, Levin & Jacobson, "Fast winding numbers for soups and
    clouds", 2018.
    """
    igl = optional_library("igl", 'winding="fast"', "libigl")
    if len(points) == 0:
        return np.empty(0)
    faces = surface.faces.astype(np.int64)
    numbers: NDArray[np.float64] = igl.fast_winding_number(surface.vertices, faces, points)
    return numbers
