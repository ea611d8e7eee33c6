"""Give work to a process of its own, so that nothing it does ends this one."""

from __future__ import annotations

import os
import subprocess
import sys
import tempfile
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from .result import MethodFailedError

ROOT = Path(__file__).resolve().parents[2]
COMMAND = (sys.executable, "-m", "cutcell.workers")
LIMIT = 120.0
"""Seconds that any such process may take, unless told otherwise."""


def run_apart(task: str, job: Mapping[str, Any], limit: float, who: str) -> dict[str, Any]:
    """Do a task of `cutcell.workers`.

    Parameters
    ----------
    task : str
        See `cutcell.workers.__main__`.
    job : mapping of names to arrays
    limit : float
        Seconds after which to give up.
    who : str
        Whose fault a crash is, for the message.

    Returns
    -------
    dict of arrays

    Raises
    ------
    MethodFailedError
        There is no result; the sentence says why.
    """
    with tempfile.TemporaryDirectory() as folder:
        job_path, result_path = Path(folder, "job.npz"), Path(folder, "result.npz")
        np.savez(job_path, **job)
        command = [*COMMAND, task, str(job_path), str(result_path)]
        path = os.pathsep.join(filter(None, [str(ROOT), os.environ.get("PYTHONPATH")]))
        try:
            done = subprocess.run(
                command,
                capture_output=True,
                text=True,
                timeout=limit,
                check=False,
                cwd=folder,  # some leave files where they run
                env={**os.environ, "PYTHONPATH": path},
            )
        except subprocess.TimeoutExpired:
            raise MethodFailedError(f"{who} took longer than {limit:g} seconds") from None
        if done.returncode != 0 or not result_path.exists():
            raise MethodFailedError(_last_words(done, who))
        with np.load(result_path) as result:
            found = {name: result[name] for name in result.files}
    if "failed" in found:
        raise MethodFailedError(str(found["failed"]))
    return found


def _last_words(done: subprocess.CompletedProcess, who: str) -> str:
    if done.returncode < 0:
        return f"{who} crashed (signal {-done.returncode})"
    lines = done.stderr.strip().splitlines() or ["it said nothing"]
    return f"{who} stopped with exit code {done.returncode}: {lines[-1]}"
