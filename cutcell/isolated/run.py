"""Run a task in a subprocess, so that a crash does not end this process."""

from __future__ import annotations

import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from contextvars import ContextVar
from pathlib import Path
from typing import Any

import numpy as np

from ..errors import CutcellError
from ..runtime.subprocesses import python_environment

COMMAND = (sys.executable, "-m", "cutcell.isolated")
LIMIT = 120.0
"""Seconds that any such process may take, unless told otherwise."""

ASK_EVERY = 0.1
"""Seconds between two questions whether the result is still wanted."""

_WANTED: ContextVar[Callable[[], object]] = ContextVar("_WANTED", default=lambda: None)


@contextmanager
def stoppable(wanted: Callable[[], object]) -> Iterator[None]:
    """Within this block, poll a function while a subprocess runs; it raises to cancel."""
    token = _WANTED.set(wanted)
    try:
        yield
    finally:
        _WANTED.reset(token)


class WorkFailedError(CutcellError):
    """Isolated work has no result; its caller reports what that means."""


def run_isolated(
    task: str,
    job: Mapping[str, Any],
    limit: float,
    who: str,
    memory: int = 0,
    extra: str = "cutcell",
) -> dict[str, Any]:
    """Call a function, named as "module:function", in a subprocess; it takes and returns arrays.

    If its library is missing, the error says to install `extra`.
    """
    with tempfile.TemporaryDirectory() as folder:
        job_path, result_path = Path(folder, "job.npz"), Path(folder, "result.npz")
        np.savez(job_path, **job)
        command = [*COMMAND, task, str(job_path), str(result_path), str(memory)]
        done = _done(command, folder, limit, who)
        if done.returncode != 0 or not result_path.exists():
            raise WorkFailedError(_last_words(done, who))
        with np.load(result_path) as result:
            arrays = {name: result[name] for name in result.files}
    if "missing" in arrays:
        raise WorkFailedError(f"{arrays['missing']} is not installed; try: pip install '{extra}'")
    if "failed" in arrays:
        raise WorkFailedError(str(arrays["failed"]))
    return arrays


def _done(command: list[str], folder: str, limit: float, who: str) -> subprocess.CompletedProcess:
    wanted, end = _WANTED.get(), time.monotonic() + limit
    # Some leave files where they run.
    process = subprocess.Popen(
        command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, cwd=folder,
        env=python_environment(),
    )  # fmt: skip
    with process:
        try:
            while True:
                wanted()
                left = end - time.monotonic()
                try:
                    out, err = process.communicate(timeout=max(min(ASK_EVERY, left), 0))
                except subprocess.TimeoutExpired:
                    if left <= 0:
                        raise WorkFailedError(f"{who} took longer than {limit:g} seconds") from None
                    continue
                return subprocess.CompletedProcess(command, process.returncode, out, err)
        except BaseException:
            process.kill()
            raise


def _last_words(done: subprocess.CompletedProcess, who: str) -> str:
    if done.returncode < 0:
        return f"{who} crashed (signal {-done.returncode})"
    lines = done.stderr.strip().splitlines() or ["it said nothing"]
    return f"{who} stopped with exit code {done.returncode}: {lines[-1]}"
