"""The character coloured by the distance to one joint's bones, with iso-lines."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from cutcell.rig import Rig

from .character import attachments, body, bones
from .description import Description, Legend, Reading


def distance_scene(
    rig: Rig,
    distance: ArrayLike,
    joint: int,
    *,
    weights: ArrayLike | None = None,
    skeleton: bool = True,
    **look: Any,
) -> Description:
    """Return the scene of one joint's distance field on the mesh.

    Parameters
    ----------
    rig : Rig
    distance : array_like, shape (n,)
        Of every vertex, in unit-cube lengths; inf where nothing was reached.
    joint : int
        The joint that it belongs to.
    weights : array_like, shape (n, j), optional
        How the body follows the joints.
    skeleton : bool
    **look
        Other fields of the body's `Actor`.

    Returns
    -------
    Description
        With the actors "body", "bones" and the attachments.
    """
    colors, legend = distance_colors(rig, distance, joint)
    actors = {
        "body": body(rig, weights, **colors, **look),
        **attachments(rig),
        "bones": bones(rig, joint, skeleton),
    }
    return Description(actors, legend=legend)


def distance_colors(rig: Rig, distance: ArrayLike, joint: int) -> tuple[dict[str, Any], Legend]:
    """Return the fields of the body's `Actor` that colour it, and how to read them."""
    limits = distance_limits(distance)
    values = shown_distance(distance, limits)
    reading = Reading(f"from {rig.skeleton.names[joint]}: ")
    colors = {"scalars": values, "colormap": "distance", "limits": limits, "reading": reading}
    return colors, distance_legend(rig, joint, limits)


def distance_limits(distance: ArrayLike) -> tuple[float, float]:
    """Return the range of the finite distances, from zero."""
    finite = np.asarray(distance, float)
    finite = finite[np.isfinite(finite)]
    return (0.0, float(finite.max()) if len(finite) and finite.max() > 0 else 1.0)


def shown_distance(distance: ArrayLike, limits: tuple[float, float]) -> NDArray[np.float32]:
    """Return distances that a colour map can show: what was not reached is farthest."""
    values = np.asarray(distance, float)
    return np.where(np.isfinite(values), values, limits[1]).astype(np.float32)


def distance_legend(rig: Rig, joint: int, limits: tuple[float, float]) -> Legend:
    """Return the legend of one joint's distance field, in parts of the longest side."""
    name = rig.skeleton.names[joint]
    return Legend(f"Distance from {name}", "distance", "0", f"{limits[1]:.2f} of the longest side")
