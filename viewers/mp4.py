"""MP4 films, encoded by ffmpeg: a separate program, as its encoders are under the GPL."""

import re
import shutil
import subprocess
from collections.abc import Iterator
from contextlib import suppress
from itertools import chain
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from cutcell.errors import FileError, MissingLibraryError
from cutcell.runtime.writing import replacing

ENCODING = ["-c:v", "libx264", "-crf", "18", "-preset", "fast", "-pix_fmt", "yuv420p"]
CONTAINER = ["-movflags", "+faststart", "-f", "mp4"]


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


def write_mp4(path: Path, frames: Iterator[NDArray[np.uint8]], rate: int) -> None:
    """Encode a film.

    Parameters
    ----------
    path : Path
    frames : iterator of array, shape (height, width, 3), uint8
        At least one. Both sides are even.
    rate : int
        Frames a second.

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
