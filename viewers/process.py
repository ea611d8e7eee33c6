"""Drawing in a subprocess, which answers pickled requests.

Without OpenGL VTK ends its process, windows belong to one thread, and drawing takes long: none of
this may harm the caller.
"""

from __future__ import annotations

import os
import pickle
import subprocess
import sys
import threading
from contextlib import suppress
from functools import cache
from io import BytesIO
from pathlib import Path
from queue import Empty, Queue
from tempfile import TemporaryDirectory, TemporaryFile
from typing import IO, TYPE_CHECKING, Any

from cutcell.errors import CutcellError, MissingLibraryError
from cutcell.runtime.progress import Progress, silent
from cutcell.runtime.subprocesses import end_first_without_memory, python_environment
from cutcell.runtime.writing import write_all

from .order import Order
from .palette import THEMES

if TYPE_CHECKING:
    from .studio import Studio

IDLE_SECONDS = 120.0
"""Seconds without a request after which the process ends."""
ASK_EVERY = 0.1
"""Seconds between two checks whether the picture is still needed."""
MAX_MEMORY = 1 << 30
"""Bytes of a process that ends after its request, so that the next one starts another."""
MAX_SIZES = 2
"""Sizes that a process keeps windows for: a moving view is drawn smaller than a resting one."""


TRIAL = """
import cutcell_viewers.scene, pyvista
plotter = pyvista.Plotter(off_screen=True, window_size=(16, 16))
plotter.add_mesh(pyvista.Sphere())
plotter.screenshot(return_img=True)
"""


class DrawingProcess:
    """A subprocess that draws requests in turn; it starts when needed and ends when idle."""

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._process: Any = None
        self._messages: Queue[Any] = Queue()
        self._timer: threading.Timer | None = None

    def draw(self, order: Order, path: Path | None = None, progress: Progress = silent) -> Any:
        """Draw an order into a file, or return it as a PNG; other threads wait.

        Parameters
        ----------
        order : Order
        path : Path, optional
            When left out, the picture is transparent, without a legend, and has the order's tiles
            and camera: the canvas of a page.
        progress : callable
            Called with the stage and the completed part; if it raises, the process ends.

        Raises
        ------
        FileError, MissingLibraryError
            See `film.draw`; or this machine has no OpenGL.
        """
        with self._lock:
            self._restart_timer()
            process = self._process or self._start()
            try:
                pickle.dump((order, path), process.stdin, 5)
                process.stdin.flush()
                answer, is_last = self._await_answer(progress)
            except (OSError, EOFError):
                process.wait()
                reason = self._last_error_line() or f"exit code {process.returncode}"
                self._end()
                require_opengl()
                raise RuntimeError(f"the picture could not be drawn: {reason}") from None
            except BaseException:
                self._end()
                raise
            if is_last:
                self._end()
        if isinstance(answer, CutcellError):
            raise answer
        return answer

    def close(self) -> None:
        """End the process."""
        with self._lock:
            self._end()
            if self._timer is not None:
                self._timer.cancel()

    def _restart_timer(self) -> None:
        if self._timer is not None:
            self._timer.cancel()
        self._timer = threading.Timer(IDLE_SECONDS, self.close)
        self._timer.daemon = True
        self._timer.start()

    def _start(self) -> Any:
        self._errors = TemporaryFile()  # noqa: SIM115 (never full, as a pipe may be)
        self._process = subprocess.Popen(
            [sys.executable, "-c", f"import {__name__} as drawing; drawing.main()"],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=self._errors,
            env=python_environment(),
        )
        self._messages = Queue()
        pipes = self._process.stdout, self._messages
        threading.Thread(target=_read, args=pipes, daemon=True).start()
        return self._process

    def _await_answer(self, progress: Progress) -> tuple[Any, bool]:
        """Return the answer to a request, and whether it is the process's last."""
        status = "drawing", 0.0
        while True:
            progress(*status)
            with suppress(Empty):
                message = self._messages.get(timeout=ASK_EVERY)
                if message is None:
                    raise EOFError
                if message[0] == "answer":
                    return message[1:]
                status = message[1:]

    def _last_error_line(self) -> str:
        self._errors.seek(0)
        lines = self._errors.read().decode(errors="replace").strip().splitlines()
        return lines[-1] if lines else ""

    def _end(self) -> None:
        process, self._process = self._process, None
        if process is not None:
            process.kill()
            process.wait()
            with suppress(OSError):
                process.stdin.close()
            self._errors.close()


def draw_isolated(order: Order, path: str | Path, progress: Progress = silent) -> None:
    """Draw an order into a file in a new process; see `DrawingProcess.draw`.

    If `progress` raises, no file is left.
    """
    path = Path(path)
    order.check(path)
    process = DrawingProcess()
    with TemporaryDirectory(prefix="cutcell-draw-") as folder:
        drawn = Path(folder) / f"drawn{path.suffix.lower()}"
        try:
            process.draw(order, drawn, progress)
        finally:
            process.close()
        write_all({path: drawn.read_bytes()})


def require_opengl() -> None:
    """Raise a `MissingLibraryError` if VTK cannot draw without a screen."""
    if not _can_draw():
        raise MissingLibraryError(
            "this machine has no OpenGL to draw a picture with; on Debian or Ubuntu install "
            "it by: apt-get install libegl1 libgl1-mesa-dri"
        )


@cache
def _can_draw() -> bool:
    command = [sys.executable, "-c", TRIAL]
    done = subprocess.run(command, capture_output=True, timeout=120, env=python_environment())
    return done.returncode == 0


def _read(stream: IO[bytes], messages: Queue[Any]) -> None:
    """Queue pickled messages until the stream ends, then None."""
    with stream, suppress(EOFError, OSError, pickle.UnpicklingError):
        while True:
            messages.put(pickle.load(stream))
    messages.put(None)


def main() -> None:
    """Answer the requests of the input until it ends."""
    import psutil

    from .film import draw

    end_first_without_memory()
    source, sink = sys.stdin.buffer, os.fdopen(os.dup(1), "wb")
    os.dup2(2, 1)  # whatever libraries print is no message
    studios: dict[Any, Studio] = {}

    def send(*message: object) -> None:
        pickle.dump(message, sink, 5)
        sink.flush()

    while True:
        try:
            order, path = pickle.load(source)
        except EOFError:
            return
        answer: object = None
        try:
            if path is None:
                answer = _draw_canvas(order, studios)
            else:
                draw(order, path, lambda *status: send("progress", *status))
        except CutcellError as error:
            answer = error
        send("answer", answer, psutil.Process().memory_info().rss > MAX_MEMORY)


def _draw_canvas(order: Order, studios: dict[Any, Studio]) -> bytes:
    """Return a PNG of a page's canvas; studios are reused, as shaders take seconds to compile."""
    from PIL import Image

    from .studio import Studio

    key = (order.size, order.tiles, order.page_height, order.fine)
    if key not in studios:
        while len(studios) >= MAX_SIZES:
            studios.pop(next(iter(studios))).close()
        look: Any = {"transparent": True, "tiles": order.tiles, "fine": order.fine}
        theme = THEMES[order.theme]
        studios[key] = Studio(
            order.description, theme, order.size, False, order.page_height, **look
        )
    studios[key].show(order.description)
    written = BytesIO()
    picture = Image.fromarray(studios[key].draw(order.camera or studios[key].camera()))
    picture.save(written, "png", compress_level=1)
    return written.getvalue()
