"""Colours as files store them: linear, or as pictures do."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray


def linear(srgb: ArrayLike) -> NDArray[np.float64]:
    """Return colours as they are stored in pictures, from 0 to 255, as linear ones, from 0 to 1.

    References
    ----------
    IEC 61966-2-1, the transfer function of sRGB.
    """
    values = np.asarray(srgb, np.float64) / 255
    return np.where(values <= 0.04045, values / 12.92, ((values + 0.055) / 1.055) ** 2.4)


def srgb(linear: ArrayLike) -> NDArray[np.uint8]:
    """Return linear colours, from 0 to 1, as they are stored in pictures, from 0 to 255.

    NaN becomes 0, and values out of range the nearest end.

    References
    ----------
    IEC 61966-2-1, the transfer function of sRGB.
    """
    values = np.clip(np.nan_to_num(np.asarray(linear, np.float64)), 0, 1)
    bent = 1.055 * values ** (1 / 2.4) - 0.055
    return np.round(255 * np.where(values <= 0.0031308, 12.92 * values, bent)).astype(np.uint8)
