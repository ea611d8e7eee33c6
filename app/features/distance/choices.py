"""Choices of the panel Distance."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import param

from ...document.common import MOMENT
from ...document.state import Panel
from ...looks.measures import CONVERGED, MAX_MEASURES, MEASURES, RESOLUTIONS

if TYPE_CHECKING:
    from cutcell_lab.baselines.measured_distance import Measure

PANEL = Panel(
    "Distance",
    '<circle cx="5" cy="19" r="1.6"/><path d="M5 13a6 6 0 0 1 6 6M5 8.5A10.5 10.5 0 0 1 '
    '15.5 19M5 4a15 15 0 0 1 15 15"/>',
    cuts=True,
)


class Choices(param.Parameterized):
    """Which distances are seen."""

    field: Any = param.Parameter(None, doc="Distance of the chosen bone at every graph node.")
    starts = param.Boolean(False, label="Sources")
    path = param.Boolean(True, label="Shortest path from the clicked vertex")
    front = param.Number(
        0.35, bounds=(0, 1), step=0.005, label="Progress", doc="Of the wave, of all the way."
    )
    scale_end = param.Number(
        0.0, bounds=(0, 10), doc="Distance at the end of the colours; 0: the farthest of the bone."
    )
    wave = param.Boolean(False, label="Wavefront", doc="Whether `front` hides what is farther.")
    animating = param.Boolean(False, doc="Whether the wave runs.", precedence=MOMENT)
    beside_straight = param.Boolean(False, label=MEASURES["straight"])
    beside_surface = param.Boolean(False, label=MEASURES["surface"])
    beside_voxel = param.Boolean(False, label=MEASURES["voxel"])
    beside_6 = param.Boolean(False, label=MEASURES["6"])
    beside_26 = param.Boolean(False, label=MEASURES["26"])
    beside_any = param.Boolean(False, label=MEASURES["any"])
    beside_converged = param.Boolean(False, label=f"Converged: any angle, R = {CONVERGED}")
    beside_resolution: param.Selector[int] = param.Selector(
        default=64,
        objects={f"R = {n}": n for n in RESOLUTIONS},
        doc="R of voxels and graphs that stand side by side.",
    )
    measured = param.Dict({}, doc="By measure: a MeasuredDistance of the chosen bone.")

    @property
    def measures(self) -> list[Measure]:
        """The measures that stand side by side; none while there is one view."""
        chosen = [name for name in MEASURES if getattr(self, f"beside_{name}")]
        return chosen[:MAX_MEASURES]
