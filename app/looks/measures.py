"""Measures of distance: their names, and what they are computed with."""

from __future__ import annotations

from typing import TYPE_CHECKING

import cutcell

from ..document.state import State

if TYPE_CHECKING:
    from cutcell_lab.baselines.measured_distance import Measure


RESOLUTIONS = (16, 32, 64, 128)
"""R that can be compared."""


CONVERGED = 192
"""R of the distances, along paths of any angle, that others are compared with."""


MAX_MEASURES = 4
"""That stand side by side."""


MEASURES: dict[Measure, str] = {
    "straight": "Straight line",
    "surface": "Over the surface",
    "voxel": "Along voxels",
    "6": "6 neighbours",
    "26": "26 neighbours",
    "any": "Any angle",
    "converged": "Converged",
}
"""Names of the measures of distance."""


def method_of(state: State, resolution: int) -> cutcell.Method:
    """Return the method of measures side by side."""
    return cutcell.ANIMATION.with_options(
        resolution=resolution, winding_threshold=state.winding_threshold, orient=state.orient
    )
