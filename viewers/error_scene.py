"""The distance between the positions that two sets of weights give to the skin."""

from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from cutcell.rig import Rig

from .character import to_scene
from .description import Apart, Legend
from .skin import Blending, Gap

FLOOR = 3.0
"""Least end of the scale in millimetres: less would not be visible."""

WHOLE = 0.995
"""Part of the vertices within the scale: a single one would leave all others grey."""


def gap_between(
    rig: Rig, weights: ArrayLike, reference: ArrayLike, blending: Blending = "linear"
) -> Gap:
    """Return the gap between two sets of weights, for poses in the scene's space, in mm.

    The longest side of the character is scaled to 1 m.
    """
    points = to_scene(rig, rig.mesh.vertices)
    return Gap(points, weights, reference, millimetres(rig), blending)


def error_look(count: int, apart: Apart, limits: tuple[float, float]) -> dict[str, Any]:
    """Return the fields of the body's `Actor` that show the error while it is posed."""
    values = np.zeros(count, np.float32)
    return {"scalars": values, "colormap": "error", "limits": limits, "apart": apart}


def error_legend(limits: tuple[float, float]) -> Legend:
    """Return the legend of the error."""
    return Legend("Error against the file's weights", "error", "0", f"{limits[1]:g} mm")


def error_limits(lengths: ArrayLike) -> tuple[float, float]:
    """Return a range that contains nearly all errors; its end is a round number.

    Round numbers stay the same while a joint turns a little: the colours can be compared.
    """
    top = max(float(np.quantile(np.asarray(lengths), WHOLE)), FLOOR)
    power = 10.0 ** np.floor(np.log10(top))
    step = next(step for step in (1, 1.5, 2, 3, 5, 7, 10) if step * power >= top * (1 - 1e-9))
    return (0.0, float(step * power))


def millimetres(rig: Rig) -> float:
    """Return the mm of a length of 1 in the scene, where the longest side is 1 m."""
    used = to_scene(rig, rig.mesh.vertices[rig.mesh.used])
    return 1000 / float(np.ptp(used, axis=0).max())
