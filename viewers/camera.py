"""Cameras, and the framing of boxes."""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike, NDArray

VIEW_ANGLE = 30.0
PAGE_HEIGHT = 800.0
"""Height of the page's canvas in pixels, where a picture is not of a known canvas."""


@dataclass(frozen=True)
class Camera:
    """Position, target and upward direction of a view.

    `centre` is the position of the target in the picture: to the right of the middle and above
    it, in halves of the picture.
    """

    position: tuple[float, float, float]
    focal_point: tuple[float, float, float]
    up: tuple[float, float, float] = (0.0, 1.0, 0.0)
    centre: tuple[float, float] = (0.0, 0.0)


FRONT = (0.42, 0.16, 1.0)
"""Direction of the first view: from the front, a little aside and above."""
NARROW = 0.4
"""Smallest front of a box, relative to its largest side, that is looked at first."""


def framing(
    bounds: NDArray[np.float64],
    aspect: float = 1.0,
    direction: tuple[float, float, float] | None = None,
) -> Camera:
    """Return a camera that sees all of a box.

    Parameters
    ----------
    bounds : array, shape (2, 3)
    aspect : float
        Width over height of the picture.
    direction : tuple of float, optional
        From the box to the eye, not vertical; see `first_direction` for the default.
    """
    low, high = np.asarray(bounds, float)
    centre = (low + high) / 2
    right, up, toward = across(direction or first_direction(high - low))
    corners = np.array(np.meshgrid(*zip(low - centre, high - centre, strict=True))).reshape(3, -1).T
    slope = np.tan(np.radians(VIEW_ANGLE / 2))
    needed = np.maximum(np.abs(corners @ up), np.abs(corners @ right) / aspect) / slope
    distance = 1.08 * (needed + corners @ toward).max()
    position = centre + distance * toward
    return Camera(tuple(position.tolist()), tuple(centre.tolist()))


def first_direction(size: NDArray[np.float64]) -> tuple[float, float, float]:
    """Return the direction of the first view of a box: `FRONT`, unless its front is narrow.

    The largest side of a long or flat one is seen: that of a fish, the top of a butterfly.
    """
    x, y, z = size
    front, largest = x * y, max(x * y, y * z, x * z)
    if front >= NARROW * largest:
        return FRONT
    aside, above, ahead = FRONT
    above = ahead if x * z == largest else above
    return (aside, above, ahead) if x >= z else (ahead, above, aside)


def across(direction: ArrayLike, up: ArrayLike = (0, 1, 0)) -> NDArray[np.float64]:
    """Return the rows right, up and towards the eye of a view from a direction."""
    toward = np.array(direction, float)
    toward /= np.linalg.norm(toward)
    right = np.cross(np.asarray(up, float), toward)
    right /= np.linalg.norm(right)
    return np.array([right, np.cross(toward, right), toward])


def sees(camera: Camera, points: NDArray[np.float64], aspect: float = 1.0) -> bool:
    """Return whether all points (n, 3) are inside a picture of an aspect, width over height."""
    eye = np.array(camera.position)
    x, y, z = across(eye - np.array(camera.focal_point), camera.up) @ (points - eye).T
    half = -z * np.tan(np.radians(VIEW_ANGLE / 2))
    return bool(np.all((np.abs(y) <= half) & (np.abs(x) <= aspect * half)))


def around(camera: Camera, angle: float) -> Camera:
    """Return a camera that has circled its target by an angle in radians."""
    target = np.array(camera.focal_point)
    x, y, z = np.array(camera.position) - target
    c, s = np.cos(angle), np.sin(angle)
    position = target + np.array([c * x + s * z, y, c * z - s * x])
    return replace(camera, position=tuple(position.tolist()))
