"""Values between the keys of a glTF animation (specification, appendix C)."""

from __future__ import annotations

import numpy as np
import pygltflib
from numpy.typing import NDArray


def sample(
    before: NDArray, after: NDArray, left: NDArray, right: NDArray, how: str, times: NDArray,
    path: str,
) -> NDArray:  # fmt: skip
    """Interpolate channels with common keys.

    Shapes: before, after (f,), left, right (f, c, width), times (f,); returns (f, c, width).
    """
    if how == pygltflib.ANIM_STEP:
        return left
    span = after - before
    u = np.divide(times - before, span, out=np.zeros(len(times)), where=span > 0)
    u = u.clip(0, 1)[:, None, None]
    if how == pygltflib.ANIM_CUBICSPLINE:
        return _hermite(left, right, span[:, None, None], u)
    if path == "rotation":
        return _slerp(left, right, u)
    return left * (1 - u) + right * u


def _hermite(a: NDArray, b: NDArray, span: NDArray, u: NDArray) -> NDArray:
    """Cubic spline of the glTF specification, appendix C.5."""
    u2, u3 = u * u, u * u * u
    return (
        (2 * u3 - 3 * u2 + 1) * a[:, :, 1]
        + span * (u3 - 2 * u2 + u) * a[:, :, 2]
        + (3 * u2 - 2 * u3) * b[:, :, 1]
        + span * (u3 - u2) * b[:, :, 0]
    )


def _slerp(a: NDArray, b: NDArray, u: NDArray) -> NDArray:
    """Interpolate quaternions along the shorter arc; nearly equal ones linearly."""
    cosine = (a * b).sum(axis=-1, keepdims=True)
    b = np.where(cosine < 0, -b, b)
    angle = np.arccos(np.clip(np.abs(cosine), 0, 1))
    sine = np.sin(angle)
    near = sine < 1e-4
    safe = np.where(near, 1, sine)
    from_a = np.where(near, 1 - u, np.sin((1 - u) * angle) / safe)
    from_b = np.where(near, u, np.sin(u * angle) / safe)
    return from_a * a + from_b * b
