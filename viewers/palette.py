"""Every colour that the scenes use, and the colour maps that values are shown with."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache

import numpy as np
from numpy.typing import ArrayLike, NDArray

Color = tuple[float, float, float]
"""Red, green and blue from 0 to 1."""


def _rgb(red: int, green: int, blue: int) -> Color:
    return (red / 255, green / 255, blue / 255)


# The paper's three colours of a cut-cell graph.
MESH = _rgb(144, 210, 236)
INTERIOR = _rgb(255, 108, 12)
SURFACE = _rgb(153, 203, 67)

BODY = _rgb(201, 206, 214)
ATTACHMENT = _rgb(163, 170, 182)
BONE = _rgb(236, 239, 244)
BONE_IDLE = _rgb(150, 158, 172)
BONE_CHOSEN = _rgb(0, 122, 255)
GHOST = _rgb(64, 132, 255)
UNREACHED = _rgb(120, 116, 132)


@dataclass(frozen=True)
class Theme:
    """The surroundings of a scene: a vertical gradient and the ink of its text."""

    name: str
    top: Color
    bottom: Color
    ink: Color
    mesh_edge: Color


LIGHT = Theme(
    "light", _rgb(250, 251, 253), _rgb(222, 228, 236), _rgb(31, 38, 50), _rgb(58, 150, 192)
)
DARK = Theme("dark", _rgb(37, 43, 54), _rgb(17, 20, 26), _rgb(232, 236, 243), MESH)
THEMES = {theme.name: theme for theme in (LIGHT, DARK)}

# Control points of the colour maps, mixed in OKLab, so that equal steps look equal.
_MAPS: dict[str, tuple[tuple[int, int, int], ...]] = {
    # from the body's own grey to glowing orange: what a bone does not hold stays quiet
    "weight": (
        (201, 206, 214),
        (236, 197, 142),
        (247, 160, 72),
        (240, 105, 32),
        (192, 46, 30),
        (128, 14, 38),
    ),
    # from the body's own grey to dark violet: where nothing is wrong nothing is said
    "error": (
        (201, 206, 214),
        (247, 217, 126),
        (246, 148, 66),
        (218, 66, 78),
        (142, 26, 108),
        (64, 12, 78),
    ),
    # less is blue, more is red, the same is the body's own grey
    "difference": (
        (24, 78, 158),
        (92, 158, 206),
        (201, 206, 214),
        (238, 136, 96),
        (172, 22, 44),
    ),
    # near is light and warm, far is deep blue
    "distance": (
        (255, 245, 214),
        (250, 205, 128),
        (143, 198, 140),
        (45, 158, 158),
        (38, 104, 160),
        (52, 54, 128),
        (38, 22, 72),
    ),
}
TEXELS = 512
ISO_LINES = 16
"""How many equal distances are drawn as lines over the range of a distance field."""


@cache
def colormap(name: str) -> NDArray[np.uint8]:
    """Return the table of a colour map.

    Parameters
    ----------
    name : {"weight", "distance", "error", "difference"}

    Returns
    -------
    array, shape (512, 3), uint8
        The colour of values from the lower to the upper limit.
    """
    stops = _srgb_to_oklab(np.array(_MAPS[name]) / 255)
    at = np.linspace(0, len(stops) - 1, TEXELS)
    mixed = np.stack([np.interp(at, np.arange(len(stops)), c) for c in stops.T], axis=1)
    table = np.clip(_oklab_to_srgb(mixed), 0, 1)
    if name == "distance":
        table = _with_iso_lines(table)
    colors = to_bytes(table)
    colors.flags.writeable = False
    return colors


def joint_colors(parents: ArrayLike) -> NDArray[np.float64]:
    """Return one calm colour a joint, equally bright, far from its neighbours'.

    Parameters
    ----------
    parents : array_like, shape (j,)

    Returns
    -------
    array, shape (j, 3), float64
        Red, green and blue from 0 to 1.
    """
    index = np.arange(len(np.asarray(parents)))
    hue = 2 * np.pi * (0.07 + 0.61803398875 * index)  # the golden ratio never repeats a hue
    lightness = 0.78 + 0.05 * (index % 3 - 1)
    lab = np.stack([lightness, 0.095 * np.cos(hue), 0.095 * np.sin(hue)], axis=1)
    return np.clip(_oklab_to_srgb(lab), 0, 1)


def to_bytes(colors: ArrayLike) -> NDArray[np.uint8]:
    """Return colours from 0 to 1 as bytes."""
    return np.round(np.asarray(colors, float) * 255).astype(np.uint8)


def to_hex(color: Color) -> str:
    """Return a colour as it is written in a style sheet."""
    return "#" + "".join(f"{round(channel * 255):02x}" for channel in color)


def _with_iso_lines(table: NDArray[np.float64]) -> NDArray[np.float64]:
    step = TEXELS / ISO_LINES
    line = (np.arange(TEXELS) % step) < 2.5
    line[: int(step / 2)] = False
    return np.where(line[:, None], table * 0.62, table)


def _srgb_to_oklab(rgb: NDArray[np.float64]) -> NDArray[np.float64]:
    linear = np.where(rgb <= 0.04045, rgb / 12.92, ((rgb + 0.055) / 1.055) ** 2.4)
    return np.cbrt(linear @ _RGB_TO_LMS.T) @ _LMS_TO_LAB.T


def _oklab_to_srgb(lab: NDArray[np.float64]) -> NDArray[np.float64]:
    linear = (lab @ np.linalg.inv(_LMS_TO_LAB).T) ** 3 @ np.linalg.inv(_RGB_TO_LMS).T
    linear = np.maximum(linear, 0)
    return np.where(linear <= 0.0031308, linear * 12.92, 1.055 * linear ** (1 / 2.4) - 0.055)


# Björn Ottosson, "A perceptual color space for image processing", 2020.
_RGB_TO_LMS = np.array(
    [
        [0.4122214708, 0.5363325363, 0.0514459929],
        [0.2119034982, 0.6806995451, 0.1073969566],
        [0.0883024619, 0.2817188376, 0.6299787005],
    ]
)
_LMS_TO_LAB = np.array(
    [
        [0.2104542553, 0.7936177850, -0.0040720468],
        [1.9779984951, -2.4285922050, 0.4505937099],
        [0.0259040371, 0.7827717662, -0.8086757660],
    ]
)
