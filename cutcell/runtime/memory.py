"""How much memory is free, and a refusal of what would not fit before it is taken."""

from __future__ import annotations

import re
from contextlib import suppress
from functools import cache
from pathlib import Path

import psutil

from ..errors import TooLargeError

SHARE = 0.8
"""Share of the free memory that one result may take."""
BYTES_PER_WEIGHT = 8

CGROUPS = Path("/sys/fs/cgroup")
OWN_CGROUP = Path("/proc/self/cgroup")


def check_matrix(vertices: int, joints: int, copies: int = 1) -> None:
    """Raise an error if weights of some vertices and joints do not fit in memory."""
    what = f"weights of {vertices:,} vertices for {joints:,} joints"
    needed = float(vertices) * joints * copies * BYTES_PER_WEIGHT
    check_room(needed, what, "leave out vertices or joints")


def check_room(needed: float, what: str, advice: str) -> None:
    """Refuse what takes more bytes than are free."""
    free = available_memory() * SHARE
    if needed > free:
        raise TooLargeError(
            f"{what} need about {gigabytes(needed)}, but only {gigabytes(free)} of memory are free "
            f"for them; {advice}"
        )


def gigabytes(size: float) -> str:
    """Write a number of bytes with two digits that count."""
    return f"{float(f'{size / 1e9:.2g}'):,.15g} GB"


def available_memory() -> int:
    """Return how many bytes new data may take without swapping.

    The limits of control groups (containers), version 2, are respected.
    """
    return min([psutil.virtual_memory().available, *map(_free_in, _limited_groups())])


def _free_in(group: Path) -> int:
    """Return what the processes of a control group may take in addition; files make way."""
    limit, usage = (int((group / name).read_text()) for name in ("memory.max", "memory.current"))
    reclaimable = re.search(r"^inactive_file (\d+)", (group / "memory.stat").read_text(), re.M)
    return max(limit - usage + (int(reclaimable[1]) if reclaimable else 0), 0)


@cache
def _limited_groups() -> tuple[Path, ...]:
    """List the control groups of this process, and those above them, that have a limit."""
    groups = []
    with suppress(OSError, StopIteration):
        lines = OWN_CGROUP.read_text().splitlines()
        innermost = CGROUPS / next(line[4:] for line in lines if line.startswith("0::/"))
        for group in (innermost, *innermost.parents):
            with suppress(OSError, ValueError):  # no such file; or the limit is the word "max"
                _free_in(group)
                groups.append(group)
    return tuple(groups)
