"""The images of a file's materials as layers of one size, for a graphics card."""

import warnings
from collections.abc import Sequence
from dataclasses import dataclass
from io import BytesIO

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from cutcell.io.materials.face_colors import FaceColors, Layer, Materials, StoredImage
from cutcell.io.materials.transfer import read_materials
from cutcell.rig import Rig

FORMATS = ("PNG", "JPEG", "WEBP", "BMP", "TGA")
MAX_IMAGE_PIXELS = 2**26
"""Pixels of an image that is decoded: 8192 by 8192."""
SIDES = (1024, 512, 256, 128)
MAX_PIXELS = 2**23
"""Largest size of all layers together: 32 MB."""
MAX_LAYERS = 64
OPAQUE = 255
HALF = 128
"""The alpha at which layers are cut."""


@dataclass(frozen=True, eq=False)
class Textures:
    """A rig's decoded materials: its images, and their parts on each face.

    Parameters
    ----------
    images : array, shape (k, s, s, 4), uint8
        The layers, sRGB. Pixels with alpha below a half are left out; where a surface is
        blended, alpha is its opacity.
    body : FaceColors
        In the order of the faces of the body's `Actor`.
    attachments : tuple of FaceColors
    notes : tuple of str
        Messages about images that could not be read.
    """

    images: NDArray[np.uint8]
    body: FaceColors
    attachments: tuple[FaceColors, ...]
    notes: tuple[str, ...] = ()


def load_textures(rig: Rig) -> Textures | None:
    """Read and decode the materials of a rig's file; None where `read_materials` returns that."""
    materials = read_materials(rig)
    if materials is None:
        return None
    return as_textures(rig, materials, *decoded(materials.images, materials.layers))


def decoded(
    images: Sequence[StoredImage], layers: Sequence[Layer]
) -> tuple[NDArray[np.uint8], dict[int, str]]:
    """Decode images into layers of one size.

    Parameters
    ----------
    images : sequence of StoredImage
    layers : sequence of Layer

    Returns
    -------
    images : array, shape (k, s, s, 4), uint8
        White where an image cannot be shown.
    problems : dict of int to str
        Why some layers cannot be.
    """
    used_layers, surplus = layers[:MAX_LAYERS], range(MAX_LAYERS, len(layers))
    problems = dict.fromkeys(surplus, f"{MAX_LAYERS} images of a file are shown, it has more")
    opened = [_opened(image) for image in images]
    side = _side(opened, len(used_layers))
    pixels = np.full((len(used_layers), side, side, 4), OPAQUE, np.uint8)
    for k, layer in enumerate(used_layers):
        image = opened[layer.image]
        problem = image if isinstance(image, str) else _fill(pixels[k], images[layer.image], layer)
        if problem:
            problems[k] = problem
    return pixels, problems


def none_decoded(layers: Sequence[Layer], why: str) -> tuple[NDArray[np.uint8], dict[int, str]]:
    """Return the result of `decoded` where no image can be shown."""
    return np.zeros((0, 1, 1, 4), np.uint8), dict.fromkeys(range(len(layers)), why)


def as_textures(
    rig: Rig, materials: Materials, images: NDArray[np.uint8], problems: dict[int, str]
) -> Textures:
    """Return a rig's textures from its materials and what `decoded` returns.

    Layers that cannot be shown are replaced by their materials' colours.
    """
    notes = {
        f"{materials.images[materials.layers[k].image].name} cannot be shown: {problem}": None
        for k, problem in problems.items()
    }
    layer_numbers = np.array(
        [-1.0 if k in problems else k for k in range(len(materials.layers))] + [-1.0]
    )
    is_mirrored = bool(np.linalg.det(rig.world[:3, :3]) < 0)

    def turned(colors: FaceColors) -> FaceColors:
        corners = colors.corners.copy()
        tints, layers = colors.tints.copy(), corners[..., 2].astype(int)
        for k in problems:
            if (instead := materials.layers[k].color) is not None:
                tints[layers == k] = instead
        corners[..., 2] = layer_numbers[layers]
        way = slice(None, None, -1 if is_mirrored else 1)  # as the faces, see `character`
        return FaceColors(
            np.ascontiguousarray(corners[:, way]),
            np.ascontiguousarray(tints[:, way]),
            np.ascontiguousarray(colors.opacity[:, way]),
            colors.materials,
        )

    return Textures(
        images,
        turned(materials.body),
        tuple(map(turned, materials.attachments)),
        (*materials.notes, *notes),
    )


def _opened(image: StoredImage) -> tuple[int, int] | str:
    """Return the size of an image from its header, or the problem with it."""
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("error", Image.DecompressionBombWarning)
            with Image.open(BytesIO(image.content), formats=FORMATS) as picture:
                width, height = picture.size
    except (Image.DecompressionBombWarning, Image.DecompressionBombError):
        return _TOO_LARGE
    except Exception:  # whatever Pillow's readers make of it
        return "it is no PNG, JPEG, WebP, BMP or TGA, or damaged"
    return _TOO_LARGE if width * height > MAX_IMAGE_PIXELS else (width, height)


_TOO_LARGE = "it has more than 67 million pixels"


def _side(opened: Sequence[tuple[int, int] | str], layers: int) -> int:
    """Return the side of all layers, by the largest image and the memory of all."""
    largest = max((max(one) for one in opened if not isinstance(one, str)), default=1)
    fitting = [side for side in SIDES if layers * side * side <= MAX_PIXELS]
    enough = [side for side in fitting if side >= largest]
    return min(enough, default=fitting[0]) if layers else 1


def _fill(pixels: NDArray[np.uint8], image: StoredImage, layer: Layer) -> str:
    """Decode an image into a layer, shape (s, s, 4); return the problem with it, or ""."""
    side = len(pixels)
    try:
        with Image.open(BytesIO(image.content), formats=FORMATS) as picture:
            picture.draft("RGB", (side, side))
            whole = picture.convert("RGBA")
    except Exception:  # whatever Pillow's readers make of it
        return "it is damaged"
    squares = layer.nearest and max(whole.size) < side
    how = Image.Resampling.NEAREST if squares else Image.Resampling.BILINEAR
    # Apart from each other: colours would fade to black where alpha is none.
    pixels[..., :3] = np.asarray(whole.convert("RGB").resize((side, side), how))
    if layer.cutoff is None and not layer.blended:
        return ""
    alpha = np.asarray(whole.getchannel("A").resize((side, side), how), float)
    if layer.cutoff is not None:
        alpha = alpha * HALF / (OPAQUE * max(layer.cutoff, 1 / OPAQUE))
    pixels[..., 3] = np.clip(alpha, 0, OPAQUE).round()
    return ""
