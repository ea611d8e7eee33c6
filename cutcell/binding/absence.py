"""A joint's distance at a vertex, and the reason why it has no weight there."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from ..animation.falloff.context import Context
from ..animation.falloff.division import POWER, facing
from ..animation.falloff.pipeline import TAIL
from ..geodesics.fallback import REACHED
from ..runtime.display import count

NOTICED = 1e-4
"""A joint with less after a step has lost its share."""
AT_STEP = {
    "rigid": "The connected component moves as a whole with other joints.",
    "tail": f"Its share was below {TAIL:.0%} of the largest, which is subtracted from all shares.",
    "storable": "The file cannot store weights of this joint at the vertex.",
    "threshold": "Its weight was below the threshold, {threshold:.1%} of the sum.",
    "limit": "{others} more weight, and {limit} are kept.",
}
"""Sentences for steps of the binding; others are called by their labels."""


def rank_of(context: Context, vertex: int, joint: int, length: float) -> int | None:
    """Return the rank of a joint among those near a vertex, 1 for the nearest; None without a path.

    The length is the joint's distance, or that of its path where it is not among the nearest.
    """
    near = context.distances.at(slice(None), vertex)
    if not np.isfinite(near[joint]) and not length:
        return None
    return 1 + int((near < min(near[joint], length or np.inf)).sum())


def factors_of(context: Context, vertex: int, joint: int) -> dict[str, float]:
    """Return what the falloff multiplies a joint's distance by."""
    gain = 1.0 if context.adjustments is None else float(context.adjustments.gain[joint])
    of_gain = {} if gain == 1 else {"gain": 1 / gain}
    if context.method.falloff == "paper":
        return of_gain
    division, node = context.division, context.graph.vertex_node[vertex]
    surface = division.surface
    radius = 1.0
    if division.beyond[node]:  # elsewhere nothing is beyond any radius
        radius = float(context.distances.at_welded[joint, node] / division.radius[joint])
    away = facing(surface.points[node], surface.normals[node], context.distances.bones, joint)
    return {
        "component": float(division.penalty[surface.component[node], joint]) * gain,
        "radius": max(1.0, radius),
        "facing": 1 / away,
        **of_gain,
    }


def absence_of(
    context: Context,
    vertex: int,
    joint: int,
    has_path: bool,
    factors: Mapping[str, float],
    steps: Mapping[str, NDArray[np.float64]],
    labels: Mapping[str, str],
) -> str:
    """Return why a joint has no weight at a vertex, in a sentence.

    The factors are those of its distance, see `JointShare`; the steps have the weights (j,) of the
    vertex after each, and the labels are of steps before layers.
    """
    distances = context.distances
    if joint not in distances.bones.joint:
        return "The joint does not deform the mesh."
    if context.allowed is not None and not context.allowed[vertex, joint]:
        return AT_STEP["storable"]
    alive = [name for name, row in steps.items() if row[joint] > NOTICED]
    if not alive:
        return _without_share(context, vertex, joint, has_path, factors)
    names = list(steps)
    lost = names[names.index(alive[-1]) + 1]
    if lost not in labels:
        return f"The layer “{lost}” gives it no weight."
    if lost != "limit":
        return AT_STEP.get(lost, f"Its weight was removed at “{labels[lost]}”.")
    before, limit = steps[alive[-1]], context.method.max_influences
    others = int((before > before[joint]).sum())
    code = "limit" if limit is not None and others >= limit else "threshold"
    return AT_STEP[code].format(
        others=count(others, "joint", "have"), limit=limit, threshold=context.method.threshold
    )


def _without_share(
    context: Context, vertex: int, joint: int, has_path: bool, factors: Mapping[str, float]
) -> str:
    """Return why a joint has no share of the first step."""
    near = context.distances.at(slice(None), vertex)
    if context.distances.fallback[vertex] != REACHED and not np.isfinite(near[joint]):
        return "No path reaches the vertex, and other bones are nearer in a straight line."
    if not has_path and not np.isfinite(near[joint]):
        return "No path through the body leads from the vertex to the joint."
    if not np.isfinite(near[joint]):
        return "It is farther than the nearest joints, which share the vertex."
    barred = factors.get("component", 1.0)
    ratio = near[joint] * np.prod(list(factors.values())) / barred / near.min()
    if barred > 1 and ratio**-POWER > NOTICED:
        return "Its bone lies in another connected component, which counts as farther."
    return f"It is too far: its distance is {near[joint] / near.min():.2g} times the smallest."
