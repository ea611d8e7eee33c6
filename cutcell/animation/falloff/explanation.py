"""What the falloff for rigs makes of one vertex, in words and numbers."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from .division import POWER, facing
from .pipeline import WEIGHT_FLOOR, RigFalloff

FALLOFF_LABELS = {
    "falloff": "shares by distance",
    "spread": "spread over skin",
    "rigid": "rigid components",
    "tail": "tail subtracted",
}
"""Labels of the steps."""
LOST_AT = {
    "rigid": "The connected component moves as a whole with other joints.",
    "tail": f"Its share was below {WEIGHT_FLOOR:.0%} of the largest, which is subtracted from all.",
}
"""Why a joint has no weight after a step that removed it."""


def factors_of(falloff: RigFalloff, vertex: int, joint: int, gain: float) -> dict[str, float]:
    """Return what a joint's distance at a vertex is multiplied by, beside the joint's gain."""
    division, surface, distances = falloff.division, falloff.surface, falloff.distances
    node, radius = distances.graph.vertex_node[vertex], 1.0
    if division.beyond[node]:  # elsewhere nothing is beyond any radius
        radius = float(distances.at(joint, vertex) / division.radius[joint])
    away = facing(surface.points[node], surface.normals[node], distances.bones, joint)
    return {
        "component": float(division.penalty[surface.component[node], joint]) * gain,
        "radius": max(1.0, radius),
        "facing": 1 / away,
    }


def is_barred(ratio: float, factors: Mapping[str, float], noticed: float) -> bool:
    """Return whether a joint has no share only because its bone is in another component.

    The ratio is of its distance to the smallest.
    """
    component = factors["component"]
    ratio *= float(np.prod(list(factors.values()))) / component
    return component > 1 and ratio**-POWER > noticed
