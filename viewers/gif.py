"""GIF films, encoded by Pillow."""

import zlib
from collections.abc import Iterator
from io import BytesIO
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from cutcell.runtime.writing import write_all


def write_gif(path: Path, frames: Iterator[NDArray[np.uint8]], rate: int) -> None:
    """Encode a film.

    Parameters
    ----------
    path : Path
    frames : iterator of array, shape (height, width, 3), uint8
        At least one.
    rate : int
        Frames a second.

    Raises
    ------
    FileError
        The file cannot be written.
    """
    # One palette for all frames: what stands still does not flicker, and the file is small.
    # Till it is known the frames are kept packed; most of each is one smooth gradient.
    packed: list[bytes] = []
    shape: tuple[int, ...] = ()
    for pixels in frames:
        shape = pixels.shape
        packed.append(zlib.compress(pixels.tobytes(), 1))

    def unpacked(at: int) -> NDArray[np.uint8]:
        return np.frombuffer(zlib.decompress(packed[at]), np.uint8).reshape(shape)

    sampled = range(0, len(packed), max(len(packed) // 8, 1))
    palette = palette_of(np.concatenate([unpacked(at)[::2, ::2] for at in sampled]))

    def images() -> Iterator[Image.Image]:
        for at in range(len(packed)):
            picture = Image.fromarray(unpacked(at))
            yield picture.quantize(palette=palette, dither=Image.Dither.NONE)

    every = images()
    written = BytesIO()
    next(every).save(
        written,
        format="gif",
        save_all=True,
        append_images=every,
        duration=1000 // rate,
        loop=0,
    )
    write_all({path: written.getvalue()})


def palette_of(pixels: NDArray[np.uint8]) -> Image.Image:
    """Return 256 colours for pictures: half for what is frequent, half for all that is there.

    A legend's colours are few pixels in a large background, and must stay distinguishable.

    Parameters
    ----------
    pixels : array, shape (height, width, 3), uint8
        Of all the pictures that share the colours.

    Returns
    -------
    PIL.Image.Image
        For the `palette` of `Image.quantize`.
    """
    flat = pixels.reshape(-1, 3)
    every = np.unique(flat >> 2, axis=0) << 2
    repeats = max(len(flat) // max(len(every), 1), 1)
    mixed = np.concatenate([flat, np.repeat(every, repeats, axis=0)])
    rows = mixed[: len(mixed) // 256 * 256].reshape(-1, 256, 3)
    return Image.fromarray(np.ascontiguousarray(rows)).quantize(256, Image.Quantize.MEDIANCUT)
