"""Draws in another process: `python -m cutcell_viewers.worker ORDER OUT`.

Without OpenGL VTK ends its process, windows belong to one thread, and what is drawn takes
long: none of this shall harm the caller.
"""

import json
import pickle
import subprocess
import sys
import tempfile
import threading
from pathlib import Path
from queue import Empty, Queue
from typing import Any

from cutcell import errors
from cutcell.errors import CutcellError
from cutcell.runtime.progress import Progress, silent
from cutcell.runtime.subprocesses import python_environment
from cutcell.runtime.writing import write_all

from .film import Order, draw
from .opengl import require_opengl

ASK_EVERY = 0.1
"""Seconds between two checks whether the picture is still needed."""


def draw_apart(order: Order, path: str | Path, progress: Progress = silent) -> None:
    """Draw an order into a file, in another process; see `draw`.

    Parameters
    ----------
    order : Order
    path : str or Path
    progress : callable
        Called with the stage and the completed part; where it raises, the other process is
        stopped and no file is left.

    Raises
    ------
    FileError, MissingLibraryError
        See `draw`; and this machine has no OpenGL.
    """
    path = Path(path)
    order.check(path)
    with tempfile.TemporaryDirectory(prefix="cutcell-draw-") as folder:
        order_path, drawn = Path(folder) / "order", Path(folder) / f"drawn{path.suffix.lower()}"
        order_path.write_bytes(pickle.dumps(order))
        command = [sys.executable, "-m", __name__, str(order_path), str(drawn)]
        with subprocess.Popen(
            command,
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
            env=python_environment(),
        ) as process:
            grumble = _watch(process, progress)
        if process.returncode or not drawn.exists():
            require_opengl()
            raise RuntimeError(f"the picture could not be drawn: {grumble}")
        write_all({path: drawn.read_bytes()})


def _watch(process: subprocess.Popen[str], progress: Progress) -> str:
    """Pass on what a drawing process tells until it ends; return what it complained of last."""
    lines: Queue[str | None] = Queue()
    grumbles: list[str] = []

    def listen() -> None:
        for line in process.stdout or ():
            lines.put(line)
        lines.put(None)

    # Both are read as they come, so that the process never waits for a reader.
    threading.Thread(target=listen, daemon=True).start()
    other = threading.Thread(target=lambda: grumbles.extend(process.stderr or ()), daemon=True)
    other.start()
    status: dict[str, Any] = {"stage": "drawing", "fraction": 0.0}
    try:
        while True:
            progress(status["stage"], status["fraction"])
            try:
                line = lines.get(timeout=ASK_EVERY)
            except Empty:
                continue
            if line is None:
                break
            status = json.loads(line)
            if "error" in status:
                raise getattr(errors, status["error"], CutcellError)(status["message"])
        other.join()
        process.wait()
        return "".join(grumbles[-1:]).strip() or f"exit code {process.returncode}"
    finally:
        if process.poll() is None:
            process.kill()


def main(order: str, out: str) -> None:
    """Draw an order that was stored in a file; tell progress and errors line by line."""

    def report(**line: object) -> None:
        print(json.dumps(line), flush=True)

    try:
        order_ = pickle.loads(Path(order).read_bytes())
        draw(order_, out, lambda stage, fraction: report(stage=stage, fraction=fraction))
    except CutcellError as error:
        report(error=type(error).__name__, message=str(error))


if __name__ == "__main__":
    main(*sys.argv[1:])
