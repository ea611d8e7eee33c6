"""Every colour that the scenes use, and the colour maps that values are shown with."""

from dataclasses import dataclass
from functools import cache

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .color_maps import STOPS

Color = tuple[float, float, float]
"""Red, green and blue from 0 to 1."""


def _rgb(red: int, green: int, blue: int) -> Color:
    return (red / 255, green / 255, blue / 255)


# The paper's three colours of a cut-cell graph.
MESH = _rgb(144, 210, 236)
INTERIOR = _rgb(255, 108, 12)
SURFACE = _rgb(153, 203, 67)

BODY = _rgb(201, 206, 214)
# Distinct from BODY and UNREACHED in a legend, too.
ATTACHMENT = _rgb(108, 116, 132)
BONE = _rgb(236, 239, 244)
BONE_IDLE = _rgb(150, 158, 172)
BONE_EDGE = _rgb(38, 45, 58)
BONE_CHOSEN = _rgb(0, 122, 255)
GHOST = _rgb(64, 132, 255)
UNREACHED = _rgb(148, 150, 160)


# Marks: the clicked vertex, the path from it.
MARK = _rgb(232, 30, 99)
# The paper's purple: nodes where distances begin.
SOURCE = _rgb(146, 72, 190)

# Enough of a difference for colour-blind people, too: of all saturated colours of
# middle lightness each was chosen farthest from those before it, to every one of `EYES`;
# the last four are darker.
JOINT_COLORS = (
    (235, 167, 95), (62, 137, 247), (93, 232, 245), (225, 64, 116), (180, 143, 191),
    (177, 225, 161), (194, 110, 18), (102, 204, 186), (240, 208, 60), (173, 99, 196),
    (232, 122, 105), (173, 176, 246), (83, 43, 199), (95, 87, 0), (146, 0, 128), (0, 106, 75),
)  # fmt: skip
ALIKE = 0.015
"""Difference of two colours over which the penalty for giving them to neighbours falls to 1/e."""
ALL_EYES = 0.6
"""Differences to all cones count by this factor, so that neighbours differ clearly to most."""
SWEEPS = 30
"""Over the joints, at most, until no joint changes its colour; a few are enough."""

# How linear red, green and blue are seen by trichromats and by those who lack the long, middle
# or short cones (Machado, Oliveira & Fernandes 2009).
EYES = {
    "all cones": ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)),
    "no long cones": (
        (0.152286, 1.052583, -0.204868),
        (0.114503, 0.786281, 0.099216),
        (-0.003882, -0.048116, 1.051998),
    ),
    "no middle cones": (
        (0.367322, 0.860646, -0.227968),
        (0.280085, 0.672501, 0.047413),
        (-0.011820, 0.042940, 0.968881),
    ),
    "no short cones": (
        (1.255528, -0.076749, -0.178779),
        (-0.078411, 0.930809, 0.147602),
        (0.004733, 0.691367, 0.303900),
    ),
}


@dataclass(frozen=True)
class Theme:
    """The surroundings of a scene: a vertical gradient and the ink of its text."""

    name: str
    top: Color
    bottom: Color
    ink: Color
    mesh_edge: Color
    surface_edge: Color

    @property
    def edges(self) -> tuple[Color, Color, Color]:
        """Return the colours of mesh, interior and surface edges."""
        return self.mesh_edge, INTERIOR, self.surface_edge


# Blue and green are the paper's hues, as light or dark as every one of `EYES` needs to tell them
# from each other, from orange, and from what is around.
LIGHT = Theme(
    "light", _rgb(250, 251, 253), _rgb(222, 228, 236), _rgb(31, 38, 50), _rgb(58, 150, 192),
    _rgb(20, 98, 10),
)  # fmt: skip
DARK = Theme(
    "dark", _rgb(37, 43, 54), _rgb(17, 20, 26), _rgb(232, 236, 243), _rgb(90, 170, 230),
    _rgb(210, 250, 150),
)  # fmt: skip
THEMES = {theme.name: theme for theme in (LIGHT, DARK)}

TEXELS = 512
UNREACHED_TEXELS = 8
"""The last texels of the map "reached", which is else like "distance"."""
ISO_LINES = 16
"""How many equal distances are drawn as lines over the range of a distance field."""


@cache
def colormap(name: str) -> NDArray[np.uint8]:
    """Return the table of a colour map.

    Parameters
    ----------
    name : {"weight", "distance", "reached", "error", "difference", "count", "depth", "winding",
        "inside"}

    Returns
    -------
    array, shape (512, 3), uint8
        The colour of values from the lower to the upper limit.
    """
    stops = _srgb_to_oklab(np.array(STOPS["distance" if name == "reached" else name]) / 255)
    at = np.linspace(0, len(stops) - 1, TEXELS)
    mixed = np.stack([np.interp(at, np.arange(len(stops)), c) for c in stops.T], axis=1)
    table = np.clip(_oklab_to_srgb(mixed), 0, 1)
    if name == "distance":
        table = _with_iso_lines(table)
    if name == "reached":
        table = _with_unreached(_with_iso_lines(table))
    colors = to_bytes(table)
    colors.flags.writeable = False
    return colors


def joint_colors(
    parents: ArrayLike,
    touching: ArrayLike = (),
    nearby: ArrayLike = (),
    sizes: ArrayLike | None = None,
) -> NDArray[np.float64]:
    """Return one colour a joint, far from its neighbours' to every kind of eye.

    Parameters
    ----------
    parents : array_like, shape (j,)
    touching, nearby : array_like, shape (k, 2), optional
        Pairs of joints whose skin touches, and of joints whose skin is near in space.
    sizes : array_like, shape (j,), optional
        How much skin each joint has. Joints with much of it differ from each other first; joints
        without any take what is left.

    Returns
    -------
    array, shape (j, 3), float64
        Red, green and blue from 0 to 1, each one of `JOINT_COLORS`.
    """
    above = np.asarray(parents, int)
    size = np.ones(len(above)) if sizes is None else np.asarray(sizes, float)
    conflict = _conflicts(above, _pairs(touching), _pairs(nearby), size)
    penalty = np.exp(-_differences() / ALIKE)
    chosen, taken = np.full(len(above), -1), np.zeros((len(above), len(penalty)))
    order = np.argsort(-conflict.sum(axis=1), kind="stable")
    for _ in range(SWEEPS):
        before = chosen.copy()
        for joint in order:
            chosen[joint] = int(np.argmin(conflict[joint] @ taken @ penalty))
            taken[joint] = np.arange(len(penalty)) == chosen[joint]
        if np.array_equal(before, chosen):
            break
    return np.array(JOINT_COLORS)[chosen] / 255


def _pairs(pairs: ArrayLike) -> NDArray[np.intp]:
    return np.asarray(pairs, int).reshape(-1, 2)


def _conflicts(
    above: NDArray, touching: NDArray, nearby: NDArray, size: NDArray
) -> NDArray[np.float64]:
    """Return how much each two joints should differ, (j, j), from parents, pairs and sizes."""
    large = np.sqrt(size / size.max(initial=1e-300))
    conflict = 1e-3 + 2e-2 * np.outer(large, large)
    child = np.flatnonzero(above >= 0)
    second = child[above[above[child]] >= 0]
    is_sibling = (above[:, None] == above) & (above >= 0)
    conflict[is_sibling] = np.maximum(conflict[is_sibling], 0.1)
    groups = [
        (np.stack([second, above[above[second]]], axis=1), 0.1),
        (nearby, 0.2),
        (np.stack([child, above[child]], axis=1), 1.0),
    ]
    for pairs, much in groups:
        for a, b in (pairs.T, pairs.T[::-1]):
            conflict[a, b] = np.maximum(conflict[a, b], much)
    conflict[size == 0] *= 0.05
    conflict[:, size == 0] *= 0.05
    for a, b in (touching.T, touching.T[::-1]):
        conflict[a, b] = 1
    np.fill_diagonal(conflict, 0)
    return conflict


@cache
def _differences() -> NDArray[np.float64]:
    """Return how much joints' colours differ to the eye that sees it least, (c, c)."""
    colors = np.array(JOINT_COLORS) / 255
    labs = _srgb_to_oklab(colors)
    to_most = np.linalg.norm(labs[:, None] - labs, axis=2)
    return np.minimum(ALL_EYES * to_most, differences(colors))


def as_seen(colors: ArrayLike, eye: str) -> NDArray[np.float64]:
    """Return colours (n, 3), from 0 to 1, as an eye sees them: one of `EYES`."""
    linear = _to_linear(np.asarray(colors, float)) @ np.array(EYES[eye]).T
    return np.clip(_from_linear(linear), 0, 1)


def differences(colors: ArrayLike) -> NDArray[np.float64]:
    """Return how far apart colours (n, 3) are in OKLab, to the eye that sees it least, (n, n)."""
    labs = np.stack([_srgb_to_oklab(as_seen(colors, eye)) for eye in EYES])
    return np.linalg.norm(labs[:, :, None] - labs[:, None], axis=3).min(axis=0)


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


def _with_unreached(table: NDArray[np.float64]) -> NDArray[np.float64]:
    at = np.linspace(0, TEXELS - 1, TEXELS - UNREACHED_TEXELS).round().astype(int)
    return np.concatenate([table[at], np.tile(UNREACHED, (UNREACHED_TEXELS, 1))])


def _to_linear(rgb: NDArray[np.float64]) -> NDArray[np.float64]:
    return np.where(rgb <= 0.04045, rgb / 12.92, ((rgb + 0.055) / 1.055) ** 2.4)


def _from_linear(linear: NDArray[np.float64]) -> NDArray[np.float64]:
    linear = np.maximum(linear, 0)
    return np.where(linear <= 0.0031308, linear * 12.92, 1.055 * linear ** (1 / 2.4) - 0.055)


def _srgb_to_oklab(rgb: NDArray[np.float64]) -> NDArray[np.float64]:
    return np.cbrt(_to_linear(rgb) @ _RGB_TO_LMS.T) @ _LMS_TO_LAB.T


def _oklab_to_srgb(lab: NDArray[np.float64]) -> NDArray[np.float64]:
    return _from_linear((lab @ np.linalg.inv(_LMS_TO_LAB).T) ** 3 @ np.linalg.inv(_RGB_TO_LMS).T)


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
