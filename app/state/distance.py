"""Choices of the panel Distance."""

from __future__ import annotations

from typing import Any, Literal

import param

Measure = Literal["straight", "surface", "voxel", "6", "26", "any", "converged"]

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


class GeodesicsChoices(param.Parameterized):
    """Which distances are seen."""

    field: Any = param.Parameter(None, doc="(distances, joint, distance at every graph node).")
    starts = param.Boolean(False, label="Sources")
    path = param.Boolean(True, label="Shortest path from the clicked vertex")
    front = param.Number(0.35, bounds=(0, 1), doc="How far the wave came, of all the way.")
    wave = param.Boolean(False, label="Wavefront", doc="Whether `front` hides what is farther.")
    animating = param.Boolean(False, doc="Whether the wave runs.")
    beside_straight = param.Boolean(False, label=MEASURES["straight"])
    beside_surface = param.Boolean(False, label=MEASURES["surface"])
    beside_voxel = param.Boolean(False, label=MEASURES["voxel"])
    beside_6 = param.Boolean(False, label=MEASURES["6"])
    beside_26 = param.Boolean(False, label=MEASURES["26"])
    beside_any = param.Boolean(False, label=MEASURES["any"])
    beside_converged = param.Boolean(False, label=f"Converged: any angle, R = {CONVERGED}")
    beside_resolution: param.Selector[int] = param.Selector(
        default=64, objects=list(RESOLUTIONS), doc="R of voxels and graphs that stand side by side."
    )
    measured = param.Dict({}, doc="By measure: (distances, joint, R, MeasuredDistance).")
    measuring = param.String("", doc="The measure that is being computed; empty for none.")

    error_curves: Any = param.Parameter(
        None, doc="(distances, joint, `ErrorPoint`s), once measured."
    )
    measuring_errors = param.Boolean(False, doc="Whether errors are being measured.")

    @property
    def measures(self) -> list[Measure]:
        """The measures that stand side by side; none while there is one view."""
        chosen = [name for name in MEASURES if getattr(self, f"beside_{name}")]
        return chosen[:MAX_MEASURES]
