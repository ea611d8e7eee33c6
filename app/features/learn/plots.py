"""Small plots of the lesson as data; see `small_plot.js`."""

from __future__ import annotations

from typing import Any

import numpy as np

from cutcell_viewers.short_names import short_names

from ..distance.choices import MEASURES

MAX_MARKS = 6
"""Joints of the clicked vertex that are marked, the nearest first."""


def plot_of(state: Any, kind: str) -> dict[str, Any] | None:
    """Return a plot of `lesson.PLOTS`, or None while there is nothing to show.

    "falloff" needs a clicked vertex, "error" the result `error_curves`, which is computed while the
    step is shown on the panel Distance.
    """
    return _falloff(state) if kind == "falloff" else _error(state)


def _falloff(state: Any) -> dict[str, Any] | None:
    """Return distances and weights of the clicked vertex.

    Under the paper's falloff the joints that it follows lie on one curve, which the browser draws.
    """
    binding, vertex = state.binding, state.vertex
    if binding is None or vertex is None:
        return None
    distance = np.asarray(binding.distances.at(slice(None), vertex)).ravel()
    nearest = np.argsort(distance, kind="stable")
    weights, is_paper = binding.weights[vertex], state.falloff == "paper"
    nearest = nearest[np.isfinite(distance[nearest]) & ((weights[nearest] > 0) | (not is_paper))]
    lattice, names = binding.graph.lattice, short_names(state.rig.skeleton.names)
    unit = lattice.size * float(np.linalg.norm(state.rig.world[:3, 0]))
    return {
        "kind": "falloff",
        "alpha": state.alpha,
        "diagonal": lattice.diagonal * unit,
        "distances": (distance[nearest] * unit).tolist(),
        "marks": [
            {
                "name": names[joint],
                "distance": float(distance[joint] * unit),
                "weight": float(weights[joint]),
                "chosen": bool(joint == state.joint),
            }
            for joint in nearest[:MAX_MARKS].tolist()
        ],
        "on_curve": is_paper,
    }


def _error(state: Any) -> dict[str, Any] | None:
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
    }
