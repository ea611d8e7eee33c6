"""Frames of the page's canvas, drawn by PyVista in one process that stays.

`python -m cutcell_viewers.frames` reads pickled frames from its input and writes each as a PNG.
"""

from __future__ import annotations

import pickle
import subprocess
import sys
import threading
from dataclasses import dataclass
from io import BytesIO
from typing import IO, TYPE_CHECKING, Any

from cutcell.errors import CutcellError
from cutcell.runtime.subprocesses import end_first_without_memory, python_environment

from .camera import Camera
from .description import Description, in_view
from .tiles import Tile

if TYPE_CHECKING:
    from .scene import Scene

IDLE_SECONDS = 120.0
"""Seconds without a frame after which the process ends."""
MAX_MEMORY = 1 << 30
"""Bytes of a process that ends after its frame, so that the next frame starts another."""
MAX_STUDIOS = 2
"""Sizes that a process keeps windows for: a moving view is drawn smaller than a resting one."""


@dataclass(frozen=True, eq=False)
class Frame:
    """A picture of the canvas on a transparent ground, without its legend and captions.

    Parameters
    ----------
    description : Description
    camera : Camera
    size : (int, int)
        Width and height in pixels.
    tiles : tuple of Tile
        Where each view lies.
    pixel_ratio : float
        How many pixels of the picture are one pixel of the page.
    fine : bool
        Whether corners are darkened by ambient occlusion and edges are smooth.
    """

    description: Description
    camera: Camera
    size: tuple[int, int]
    tiles: tuple[Tile, ...]
    pixel_ratio: float = 1.0
    fine: bool = True


class FrameProcess:
    """A process that draws frames in turn; it starts with the first and ends when idle."""

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._process: subprocess.Popen[bytes] | None = None
        self._timer: threading.Timer | None = None

    def draw(self, frame: Frame) -> bytes:
        """Return a frame as a PNG; other threads wait for their turn.

        Raises
        ------
        MissingLibraryError
            This machine has no OpenGL.
        """
        from .opengl import require_opengl

        with self._lock:
            process = self._running()
            try:
                pickle.dump(frame, _pipe(process.stdin), 5)
                _pipe(process.stdin).flush()
                picture, ends = pickle.load(_pipe(process.stdout))
            except (OSError, EOFError):
                self._end()
                require_opengl()
                raise RuntimeError("the process that draws frames has ended") from None
            if ends:
                self._end()
            if isinstance(picture, CutcellError):
                raise picture
            return bytes(picture)

    def close(self) -> None:
        """End the process."""
        with self._lock:
            self._end()

    def _running(self) -> subprocess.Popen[bytes]:
        if self._timer is not None:
            self._timer.cancel()
        self._timer = threading.Timer(IDLE_SECONDS, self.close)
        self._timer.daemon = True
        self._timer.start()
        if self._process is None:
            self._process = subprocess.Popen(
                [sys.executable, "-m", __name__],
                stdin=subprocess.PIPE,
                stdout=subprocess.PIPE,
                stderr=subprocess.DEVNULL,
                env=python_environment(),
            )
        return self._process

    def _end(self) -> None:
        process, self._process = self._process, None
        if process is not None:
            process.kill()
            process.communicate()


def _pipe(stream: IO[bytes] | None) -> IO[bytes]:
    assert stream is not None
    return stream


def main() -> None:
    """Draw what the input asks for, until it ends."""
    import psutil

    end_first_without_memory()
    studios: dict[Any, list[Scene]] = {}
    source, sink = sys.stdin.buffer, sys.stdout.buffer
    while True:
        try:
            frame: Frame = pickle.load(source)
        except EOFError:
            return
        try:
            answer: bytes | CutcellError = _draw(frame, studios)
        except CutcellError as error:
            answer = error
        ends = psutil.Process().memory_info().rss > MAX_MEMORY
        pickle.dump((answer, ends), sink, 5)
        sink.flush()


def _draw(frame: Frame, studios: dict[Any, list[Scene]]) -> bytes:
    """Return a frame as a PNG; scenes are reused, as their shaders take seconds to compile."""
    from PIL import Image

    from .scene import Scene

    key = (frame.size, frame.tiles, frame.pixel_ratio, frame.fine)
    if key not in studios:
        while len(studios) >= MAX_STUDIOS:
            for scene in studios.pop(next(iter(studios))):
                scene.close()
        studios[key] = [
            Scene(size=tile[2:], fine=frame.fine, pixel_ratio=frame.pixel_ratio)
            for tile in frame.tiles
        ]
    picture = Image.new("RGBA", frame.size)
    for view, (scene, tile) in enumerate(zip(studios[key], frame.tiles, strict=True)):
        scene.show(in_view(frame.description, view))
        scene.set_camera(frame.camera)
        picture.paste(Image.fromarray(scene.render_clear(), "RGBA"), tile[:2])
    written = BytesIO()
    picture.save(written, "png", compress_level=1)
    return written.getvalue()


if __name__ == "__main__":
    main()
