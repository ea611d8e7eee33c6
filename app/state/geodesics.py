"""What a person can choose on the panel Geodesics."""

from __future__ import annotations

from typing import Any

import param


class GeodesicsChoices(param.Parameterized):
    """Which distances are seen."""

    field: Any = param.Parameter(None, doc="(distances, joint, distance at every graph node).")
    starts: Any = param.Boolean(False, label="Where distances begin")
    path: Any = param.Boolean(True, label="Shortest path from the clicked vertex")
    front: Any = param.Number(0.35, bounds=(0, 1), doc="How far the wave came, of all the way.")
    wave: Any = param.Boolean(
        False, label="Wavefront", doc="Whether `front` hides what is farther."
    )
    animating: Any = param.Boolean(False, doc="Whether the wave runs.")
