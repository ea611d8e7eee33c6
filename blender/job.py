# SPDX-License-Identifier: GPL-3.0-or-later
"""Jobs in the worker process. Needs no Blender."""

from __future__ import annotations

import json
import os
import queue
import subprocess
import sys
import tempfile
import threading
from collections.abc import Generator, Iterator
from contextlib import suppress
from pathlib import Path
from typing import Any

import numpy as np

STAGES = {
    "compile": "Compiling, once on this computer. This takes about half a minute",
    "graph": "Building the graph",
    "distances": "Measuring distances",
    "weights": "Computing weights",
    "checks": "Checking",
}


class Problem(Exception):
    """An error for the user, in a sentence."""


class Worker:
    """A process that runs one job at a time. It starts with the first job and stays for others.

    `paths` are the folders of cutcell and its libraries.
    """

    def __init__(self, paths: list[str]) -> None:
        self._paths = paths
        self.process: subprocess.Popen[str] | None = None
        self._lines: queue.Queue[str] = queue.Queue()

    def run(
        self, task: str, arrays: dict[str, np.ndarray], options: dict[str, Any], wait: float = 0.0
    ) -> Generator[tuple[str, float], None, tuple[dict[str, np.ndarray], dict[str, Any]]]:
        """Run a task: yield its stage and the fraction done, return arrays and other results.

        Each step waits at most `wait` seconds for a message of the process.

        Raises
        ------
        Problem
            The task failed, or the process ended.
        """
        with tempfile.TemporaryDirectory(prefix="cutcell-") as folder:
            paths = {name: str(Path(folder, f"{name}.npz")) for name in ("input", "output")}
            np.savez(paths["input"], **arrays)  # type: ignore[arg-type]
            self._send({"task": task, "options": options, **paths})
            status = "Starting", 0.0
            while True:
                yield status
                for message in self._receive(wait):
                    if "error" in message:
                        text = message["error"]
                        raise Problem(text[:1].upper() + text[1:].rstrip("."))
                    if "result" in message:
                        with np.load(paths["output"]) as archive:
                            return dict(archive), message["result"]
                    stage = message["stage"]
                    status = STAGES.get(stage, stage), message["fraction"]

    def stop(self) -> None:
        """End the process, whatever it does; the next job starts another."""
        if self.process is not None:
            with suppress(OSError), self.process as process:  # closes its pipes
                process.kill()
            self.process = None

    def _send(self, request: dict[str, Any]) -> None:
        if self.process is None or self.process.poll() is not None:
            self._start()
        assert self.process is not None
        assert self.process.stdin is not None
        with suppress(OSError):  # the process has ended: `_receive` raises an error
            self.process.stdin.write(json.dumps(request) + "\n")
            self.process.stdin.flush()

    def _receive(self, wait: float) -> Iterator[dict[str, Any]]:
        with suppress(queue.Empty):
            while True:
                line = self._lines.get(timeout=wait) if wait else self._lines.get_nowait()
                if not line:
                    code = None if self.process is None else self.process.wait()
                    raise Problem(f"The worker process ended (code {code}). Nothing was changed")
                yield json.loads(line)
                wait = 0.0

    def _start(self) -> None:
        self.stop()
        # -I: neither the user's packages nor PYTHONPATH may replace Blender's numpy.
        script = Path(__file__).with_name("worker.py")
        self.process = process = subprocess.Popen(
            [sys.executable, "-I", str(script), *self._paths],
            stdin=subprocess.PIPE, stdout=subprocess.PIPE, encoding="utf-8",
            env={**os.environ, "OPENBLAS_NUM_THREADS": "1"},
            creationflags=getattr(subprocess, "CREATE_NO_WINDOW", 0),
        )  # fmt: skip
        self._lines = lines = queue.Queue()

        def read() -> None:
            assert process.stdout is not None
            with process.stdout:
                for line in process.stdout:
                    lines.put(line)
            lines.put("")

        threading.Thread(target=read, daemon=True).start()
