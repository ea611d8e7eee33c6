"""Every colour that the scenes use, and the colour maps that values are shown with."""

from collections.abc import Iterable
from dataclasses import dataclass
from functools import cache

import numpy as np
from numpy.typing import ArrayLike, NDArray

from cutcell.checks import check_choice

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

# Of saved selections: the first ones are as different as can be from each other and UNREACHED.
SELECTION_COLORS = tuple(_rgb(*JOINT_COLORS[k]) for k in (1, 0, 3, 5, 9, 8, 2, 15))

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


# Blue and green are the paper's colours, as light or dark as every one of `EYES` needs to tell them
# from each other, from orange, and from what is around. The green is a little bluish: without long
# or middle cones the paper's has the hue of orange, and lines far away differ in lightness less.
LIGHT = Theme(
    "light", _rgb(250, 251, 253), _rgb(222, 228, 236), _rgb(31, 38, 50), _rgb(58, 150, 192),
    _rgb(0, 96, 64),
)  # fmt: skip
DARK = Theme(
    "dark", _rgb(37, 43, 54), _rgb(17, 20, 26), _rgb(232, 236, 243), _rgb(90, 170, 230),
    _rgb(185, 255, 222),
)  # fmt: skip
THEMES = {theme.name: theme for theme in (LIGHT, DARK)}

# Control points of the colour maps, mixed in OKLab, so that equal steps look equal.
STOPS = {
    # from the body's grey to glowing orange: vertices that a bone does not move stay quiet
    "weight": "c9ced6 ecc58e f7a048 f06920 c02e1e 800e26",
    # from the body's grey to dark violet: nothing is said where nothing is wrong
    "error": "c9ced6 f7d97e f69442 da424e 8e1a6c 400c4e",
    # less is blue, more is red, the same is the body's grey
    "difference": "184e9e 5c9ece c9ced6 ee8860 ac162c",
    # near is light and warm, far is deep blue
    "distance": "fff5d6 facd80 8fc68c 2d9e9e 2668a0 343680 261648",
    # few influences are calm, many glow
    "count": "d6e0ec 96bed6 5694b2 845ca0 60225c",
    # from the surface's green to the deepest orange
    "depth": "b0d66c ebc85a ff8c28 d6420e 781814",
    # winding numbers: outside is grey, inside orange
    "winding": "969eac b0aca8 e29e6e ff6c0c",
    # the same on the face of a cut, on which orange edges are to be seen
    "inside": "b0b6c2 d6cee2 987ebe 5c3e8c",
}

COLORMAPS = ("default", "viridis", "cividis", "plasma", "inferno", "magma", "turbo", "gray")
"""Colour maps that the page offers: ours, and some of Matplotlib's. Scenes take any of those."""
REPLACEABLE = ("weight", "distance", "reached", "depth")
"""Maps in whose place one of Matplotlib's may be chosen."""
TEXELS = 512
UNREACHED_TEXELS = 8
"""The last texels of the map "reached", which is else like "distance"."""
ISO_LINES = 16
"""Lines of equal distance over the range of a distance field."""


@cache
def colormap(name: str) -> NDArray[np.uint8]:
    """Return the table of a colour map.

    Parameters
    ----------
    name : str
        "weight", "distance", "reached", "error", "difference", "count", "depth", "winding" or
        "inside". After a colon follows the name of one of Matplotlib's maps whose colours are
        used instead: "distance:viridis" has lines of equal distance, too.

    Raises
    ------
    ParameterError
        Matplotlib has no such map.

    Returns
    -------
    array, shape (512, 3), uint8
        The colour of values from the lower to the upper limit.
    """
    field, _, other = name.partition(":")
    table = _of_matplotlib(other) if other else _of_stops(field)
    if field in ("distance", "reached"):
        table = _with_iso_lines(table)
    if field == "reached":
        table = _with_unreached(table)
    colors = to_bytes(table)
    colors.flags.writeable = False
    return colors


def _of_stops(field: str) -> NDArray[np.float64]:
    codes = STOPS["distance" if field == "reached" else field].split()
    stops = _srgb_to_oklab(np.array([list(bytes.fromhex(code)) for code in codes]) / 255)
    at = np.linspace(0, len(stops) - 1, TEXELS)
    mixed = np.stack([np.interp(at, np.arange(len(stops)), c) for c in stops.T], axis=1)
    return np.clip(_oklab_to_srgb(mixed), 0, 1)


def _of_matplotlib(name: str) -> NDArray[np.float64]:
    from matplotlib import colormaps  # 18 MB of memory, once a person chooses one

    return colormaps[check_choice("colormap", name, colormaps)](np.linspace(0, 1, TEXELS))[:, :3]


def as_seen(colors: ArrayLike, eye: str) -> NDArray[np.float64]:
    """Simulate how an eye, one of `EYES`, sees colours (n, 3) from 0 to 1."""
    linear = _to_linear(np.asarray(colors, float)) @ np.array(EYES[eye]).T
    return np.clip(_from_linear(linear), 0, 1)


def differences(colors: ArrayLike, eyes: Iterable[str] = tuple(EYES)) -> NDArray[np.float64]:
    """Return the distances (n, n) of colours (n, 3) in OKLab: the smallest over some eyes."""
    labs = np.stack([_srgb_to_oklab(as_seen(colors, eye)) for eye in eyes])
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
