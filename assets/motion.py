"""Keyframes for loops: smooth periodic curves and rotations."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .character import Motion

X, Y, Z = np.eye(3)


def loop(name: str, seconds: float, frames: int) -> Motion:
    """Return an empty motion whose last frame is to equal its first."""
    return Motion(name, np.round(np.linspace(0, seconds, frames + 1), 6))


def phase(motion: Motion) -> NDArray:
    """Return how much of the loop has passed at each key, from 0 to 1."""
    return motion.times / motion.times[-1]


def wave(t: NDArray, shift: float = 0.0, times: int = 1) -> NDArray:
    """Return a sine that starts at `shift` of its period, `times` in a loop."""
    return np.sin(2 * np.pi * (times * t - shift))


def curve(t: NDArray, keys: ArrayLike, shift: float = 0.0) -> NDArray:
    """Return a smooth periodic curve through values at equal times (Catmull-Rom)."""
    values = np.asarray(keys, float)
    x = np.mod(t - shift + 1e-12, 1.0) * len(values)
    k = np.floor(x).astype(int)
    u = x - k
    a, b, c, d = (values[(k + i) % len(values)] for i in (-1, 0, 1, 2))
    return b + u / 2 * (c - a + u * (2 * a - 5 * b + 4 * c - d + u * (3 * (b - c) + d - a)))


def turn(axis: ArrayLike, degrees: NDArray | float) -> NDArray:
    """Return quaternions (f, 4), x y z w, of turns about one axis."""
    half = np.atleast_1d(np.radians(degrees)) / 2
    axis = np.asarray(axis, float)
    axis = axis / np.sqrt((axis**2).sum())
    return np.column_stack([axis * np.sin(half)[:, None], np.cos(half)])


def after(*turns: NDArray) -> NDArray:
    """Combine turns; the last is made first, in the frame of those before it."""
    product = turns[0]
    for other in turns[1:]:
        product = _product(product, other)
    return product


def rotate(motion: Motion, joint: str, *turns: NDArray) -> None:
    """Set a joint's keys."""
    keys = after(*turns)
    keys = np.broadcast_to(keys, (len(motion.times), 4))
    motion.rotations[joint] = np.round(keys / np.linalg.norm(keys, axis=1, keepdims=True), 6)


def move(motion: Motion, joint: str, x: ArrayLike, y: ArrayLike, z: ArrayLike) -> None:
    """Set how far a joint is from its rest place at each key."""
    columns = np.broadcast_arrays(motion.times, x, y, z)[1:]
    motion.moves[joint] = np.round(np.column_stack(columns), 6)


def _product(a: NDArray, b: NDArray) -> NDArray:
    a, b = np.broadcast_arrays(a, b)
    (ax, ay, az, aw), (bx, by, bz, bw) = a.T, b.T
    return np.column_stack(
        [
            aw * bx + ax * bw + ay * bz - az * by,
            aw * by - ax * bz + ay * bw + az * bx,
            aw * bz + ax * by - ay * bx + az * bw,
            aw * bw - ax * bx - ay * by - az * bz,
        ]
    )
