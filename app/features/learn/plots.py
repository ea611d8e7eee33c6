"""Small plots of the lesson as data; see `small_plot.js`."""

from __future__ import annotations

from typing import Any

import numpy as np

from cutcell.animation.falloff.division import POWER
from cutcell.weights.paper_kernel import paper_kernel
from cutcell_viewers.distance_scene import unit_of
from cutcell_viewers.short_names import short_names

from ...document.state import State
from ...looks.measures import CONVERGED, MEASURES

POINTS = 80
MAX_MARKS = 6
"""Joints of the clicked vertex that are marked, the nearest first."""


def plot_of(state: State, kind: str) -> dict[str, Any] | None:
    """Return a plot of `lesson.PLOTS`, or None while there is nothing to show.

    "falloff" needs a clicked vertex, "error" the result `error_curves`, which is computed while the
    step is shown on the panel Distance.
    """
    return _falloff(state) if kind == "falloff" else _error(state)


def _falloff(state: State) -> dict[str, Any] | None:
    """Return weights over distances at the clicked vertex, relative to those of the nearest joint.

    The curve is that of the falloff alone; the one for animation is also smoothed and cut off.
    """
    binding, vertex = state.binding, state.vertex
    if binding is None or vertex is None:
        return None
    lattice, names = binding.graph.lattice, short_names(state.rig.skeleton.names)
    distance = np.asarray(binding.distances.at(slice(None), vertex)).ravel() * lattice.size
    nearest = np.argsort(distance, kind="stable")[:MAX_MARKS]
    nearest = nearest[np.isfinite(distance[nearest])]
    d, most = float(distance.min()), binding.weights[vertex].max()
    if not (0 < d < np.inf and most):
        return None
    weights = binding.weights[vertex] / most
    places = np.append(np.linspace(d, max(1.1 * distance[nearest].max(), 2.2 * d), POINTS), 2 * d)
    size = lattice.diagonal * lattice.size
    if state.falloff == "paper":
        pairs = paper_kernel(np.stack([np.full_like(places, d), places]), size, state.alpha)
        title, curve = "paper's falloff", pairs[:, 1] / pairs[:, 0]
    else:
        title, curve = "animation's falloff, before smoothing", (d / places) ** POWER
    return {
        "kind": "falloff",
        "unit": unit_of(state.rig),
        "curve": {"name": title, "points": np.column_stack([places, curve])[:-1].tolist()},
        "twice": [2 * d, float(curve[-1])],
        "marks": [
            {"name": names[j], "at": [distance[j], weights[j]], "chosen": j == state.joint}
            for j in nearest.tolist()
        ],
    }


def _error(state: State) -> dict[str, Any] | None:
    """Return the mean error over the resolution, a curve for each connectivity."""
    if state.error_curves is None:
        return None
    curves: dict[str, list[list[float]]] = {}
    for point in state.error_curves:
        curves.setdefault(MEASURES[point.measure], []).append([point.resolution, 100 * point.error])
    return {
        "kind": "error",
        "curves": [{"name": name, "points": points} for name, points in curves.items()],
        "at": state.resolution,
        "reference": f"any angle at R = {CONVERGED}",
    }
