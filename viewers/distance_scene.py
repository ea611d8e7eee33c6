"""The character coloured by the distance to one joint's bones, with iso-lines."""

from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from cutcell.rig import Rig

from .character import character
from .description import Description, Legend, Reading
from .palette import TEXELS, UNREACHED, UNREACHED_TEXELS
from .short_names import short_names


def distance_scene(
    rig: Rig,
    distance: ArrayLike,
    joint: int,
    *,
    weights: ArrayLike | None = None,
    skeleton: bool = True,
    **style: Any,
) -> Description:
    """Return the scene of one joint's distance field on the mesh.

    Parameters
    ----------
    rig : Rig
    distance : array_like, shape (n,)
        Of every vertex, in unit-cube lengths; inf where no path leads.
    joint : int
        The joint of the field.
    weights : array_like, shape (n, j), optional
        Weights by which the body follows the joints.
    skeleton : bool
    **style
        Other fields of the body's `Actor`.
    """
    colors, legend = distance_colors(rig, distance, joint)
    actors = character(rig, weights, joint, skeleton, **colors, **style)
    return Description(actors, legend=legend)


def distance_colors(
    rig: Rig, distance: ArrayLike, joint: int, limits: tuple[float, float] | None = None
) -> tuple[dict[str, Any], Legend]:
    """Return the fields of the body's `Actor` that colour it, and how to read them.

    Unreached points are grey. The limits default to those of the distances.
    """
    limits = limits or distance_limits(distance)
    style, unreached = distance_look(distance, limits)
    legend = distance_legend(rig, joint, limits)
    if unreached:
        legend = replace(legend, swatches=((UNREACHED, "no path leads there"),))
    name = short_names(rig.skeleton.names)[joint]
    reading = Reading(f"from {name} in {unit_of(rig)}: ", unit=longest_side(rig))
    return {**style, "reading": reading}, legend


def distance_look(distance: ArrayLike, limits: tuple[float, float]) -> tuple[dict[str, Any], bool]:
    """Return the fields of an `Actor` that show distances, and whether any is infinite."""
    distance = np.asarray(distance, float)
    unreached = ~np.isfinite(distance)
    if not unreached.any():
        values = distance.astype(np.float32)
        return {"scalars": values, "colormap": "distance", "limits": limits}, False
    end = limits[1] * TEXELS / (TEXELS - UNREACHED_TEXELS)
    values = np.where(unreached, end, np.minimum(distance, limits[1])).astype(np.float32)
    return {"scalars": values, "colormap": "reached", "limits": (0.0, end)}, True


def distance_limits(distance: ArrayLike) -> tuple[float, float]:
    """Return the range of the finite distances, from zero."""
    finite = np.asarray(distance, float)
    finite = finite[np.isfinite(finite)]
    return (0.0, float(finite.max()) if len(finite) and finite.max() > 0 else 1.0)


def shown_distance(distance: ArrayLike, limits: tuple[float, float]) -> NDArray[np.float32]:
    """Return distances that a colour map can show: unreached points are farthest."""
    values = np.asarray(distance, float)
    return np.where(np.isfinite(values), values, limits[1]).astype(np.float32)


def distance_legend(rig: Rig, joint: int, limits: tuple[float, float]) -> Legend:
    """Return the legend of one joint's distance field; limits are in longest sides."""
    name = short_names(rig.skeleton.names)[joint]
    return Legend(f"Distance from {name}", "distance", "0", file_units(limits[1], rig))


def file_units(length: float, rig: Rig) -> str:
    """Return a length in longest sides of the mesh, written in the file's units with their name."""
    in_file = length * longest_side(rig)
    return f"{in_file:{'.3g' if in_file < 1000 else '.0f'}} {unit_of(rig)}"


def unit_of(rig: Rig) -> str:
    """Return the name of the file's units: metres where a glTF scene does not scale the mesh."""
    scale = np.linalg.norm(rig.world[:3, :3], axis=0)
    return "m" if rig.source is not None and np.allclose(scale, 1, rtol=1e-3) else "units"


def longest_side(rig: Rig) -> float:
    """Return the longest side of the mesh's bounding box, in the file's units."""
    return float(np.ptp(rig.mesh.bounds, axis=0).max())
