"""Films as files: GIF by Pillow, MP4 by ffmpeg, a separate program with encoders under the GPL."""

import re
import shutil
import subprocess
import zlib
from collections.abc import Iterator
from contextlib import suppress
from io import BytesIO
from itertools import chain
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from cutcell.errors import FileError, MissingLibraryError
from cutcell.runtime.writing import replacing, write_all

Frames = Iterator[NDArray[np.uint8]]
"""At least one, shape (height, width, 3)."""
ENCODING = ["-c:v", "libx264", "-crf", "18", "-preset", "fast", "-pix_fmt", "yuv420p"]
CONTAINER = ["-movflags", "+faststart", "-f", "mp4"]


def write_gif(path: Path, frames: Frames, rate: int) -> None:
    """Encode a film of some frames a second; raise a `FileError` if it cannot be written."""
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
    images = (
        Image.fromarray(unpacked(at)).quantize(palette=palette, dither=Image.Dither.NONE)
        for at in range(len(packed))
    )
    written = BytesIO()
    options = {"save_all": True, "append_images": images, "duration": 1000 // rate, "loop": 0}
    next(images).save(written, format="gif", **options)
    write_all({path: written.getvalue()})


def palette_of(pixels: NDArray[np.uint8]) -> Image.Image:
    """Return 256 colours for pictures: half for frequent colours, half for all that occur.

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


def find_ffmpeg() -> str:
    """Return the path of ffmpeg: that of the extra `films`, or the one on the PATH.

    Raises
    ------
    MissingLibraryError
        There is none.
    """
    try:
        from imageio_ffmpeg import get_ffmpeg_exe

        return get_ffmpeg_exe()
    except (ModuleNotFoundError, RuntimeError):
        path = shutil.which("ffmpeg")
    if path is None:
        raise MissingLibraryError(
            "MP4 films need ffmpeg. Put it on the PATH, or pip install 'cutcell[films]', "
            "or save a GIF."
        )
    return path


def write_mp4(path: Path, frames: Frames, rate: int) -> None:
    """Encode a film of some frames a second; both sides of its frames are even.

    Raises
    ------
    FileError
        ffmpeg cannot write it: it lacks the encoder x264, or the disk is full.
    MissingLibraryError
        See `find_ffmpeg`.
    """
    first = next(frames)
    source = f"-f rawvideo -pix_fmt rgb24 -s {first.shape[1]}x{first.shape[0]} -r {rate} -i -"
    command = [find_ffmpeg(), "-v", "error", "-y", *source.split(), *ENCODING, *CONTAINER]
    with replacing(path) as (unready,):
        with subprocess.Popen(
            [*command, f"file:{unready}"],
            stdin=subprocess.PIPE,
            stderr=subprocess.PIPE,
            restore_signals=False,  # a file that is too large is an error, not the end of ffmpeg
        ) as ffmpeg:
            assert ffmpeg.stdin is not None
            with suppress(BrokenPipeError):  # it has ended and says why
                for pixels in chain([first], frames):
                    ffmpeg.stdin.write(pixels.tobytes())
            message = ffmpeg.communicate()[1].decode(errors="replace")
        if ffmpeg.returncode:
            reason = re.sub(r"^\[.*?\] ", "", message.strip().partition("\n")[0])
            reason = reason or f"ffmpeg ended with code {ffmpeg.returncode}"
            raise FileError(f"{path.name}: cannot be written ({reason})")
