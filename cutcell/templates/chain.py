"""A skeleton of one chain along a body without limbs: a snake, a tail, a tentacle."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from .frame import Joints
from .interior import Interior, along

ENDS = 0.12
"""Of the length: an end is as thick as its deepest point so far in."""


def place(body: Interior, names: tuple[str, ...]) -> Joints:
    """Return where joints are along the middle of a body, from its thick end to its thin one."""
    start = int(body.distances(0).argmax())
    end = int(body.distances(start).argmax())
    path = body.middle_path(start, end)
    inset = 0.5 / len(names) if len(names) > 1 else 0.5
    shares = np.linspace(0.3 * inset, 1 - inset, len(names))
    if _thickness(body, end) > _thickness(body, start):
        path = path[::-1]
    places: NDArray[np.float64] = along(path, shares)
    return dict(zip(names, places, strict=True))


def _thickness(body: Interior, end: int) -> float:
    far = body.distances(end)
    return float(body.depth[far < ENDS * far.max()].max())
