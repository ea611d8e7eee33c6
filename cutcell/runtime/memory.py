"""How much memory is free, and a refusal of what would not fit before it is taken."""

from __future__ import annotations

import math
import os
import re
from functools import cache
from pathlib import Path

from ..errors import TooLargeError

SHARE = 0.8
"""Of the free memory that one thing may take."""
BYTES_PER_WEIGHT = 8

CGROUPS = Path("/sys/fs/cgroup")
OWN_CGROUPS = Path("/proc/self/cgroup")
LIMIT = {1: "memory.limit_in_bytes", 2: "memory.max"}
USAGE = {1: "memory.usage_in_bytes", 2: "memory.current"}
RECLAIMABLE = {1: "total_inactive_file", 2: "inactive_file"}
"""Names in cgroups of version 1 and 2. What is reclaimable counts as used, but makes way."""
NO_LIMIT = 2**60
"""Version 1 says that there is no limit by a number larger than any memory."""


def check_matrix(vertices: int, joints: int, copies: int = 1) -> None:
    """Refuse weights of so many vertices and joints if they do not fit in memory."""
    needed = float(vertices) * joints * copies * BYTES_PER_WEIGHT
    check_room(
        needed,
        f"weights of {vertices:,} vertices for {joints:,} joints",
        "leave out vertices or joints",
    )


def check_room(needed: float, what: str, advice: str) -> None:
    """Refuse what takes more bytes than are free."""
    free = available_memory(needed / SHARE) * SHARE
    if needed > free:
        raise TooLargeError(
            f"{what} need about {gigabytes(needed)}, but only {gigabytes(free)} of memory are free "
            f"for them; {advice}"
        )


def gigabytes(size: float) -> str:
    """Write a number of bytes with two digits that count."""
    return f"{float(f'{size / 1e9:.2g}'):,.15g} GB"


def available_memory(enough: float = math.inf) -> int:
    """Return how many bytes new data may take without swapping, or no less than is enough.

    The limits of control groups (containers) count, too.
    """
    return min([_free_on_machine(enough), *(_free_in(*group) for group in _limited_groups())])


def _free_on_machine(enough: float) -> int:
    free = _pages("SC_AVPHYS_PAGES")
    if free >= enough:
        return free  # how much the system could clear takes far longer to find out
    try:
        found = re.search(r"MemAvailable:\s+(\d+) kB", Path("/proc/meminfo").read_text())
    except OSError:
        found = None
    if found:
        return int(found[1]) * 1024
    return _pages("SC_PHYS_PAGES") // 2


def _pages(name: str) -> int:
    """Return the size of some pages of memory, 0 where the system does not tell."""
    if name not in os.sysconf_names:
        return 0
    return os.sysconf("SC_PAGE_SIZE") * os.sysconf(name)


def _free_in(group: Path, version: int) -> int:
    """Return how much a control group lets its processes take in addition to what they have."""
    try:
        limit, usage = (int((group / name[version]).read_text()) for name in (LIMIT, USAGE))
        statistics = (group / "memory.stat").read_text()
    except (OSError, ValueError):  # the limit may be the word "max"
        return NO_LIMIT
    found = re.search(rf"^{RECLAIMABLE[version]} (\d+)", statistics, re.MULTILINE)
    return max(limit - usage + (int(found[1]) if found else 0), 0)


@cache
def _limited_groups() -> tuple[tuple[Path, int], ...]:
    """List the control groups of this process, and those above them, that have a limit."""
    try:
        lines = OWN_CGROUPS.read_text().splitlines()
    except OSError:
        return ()
    found = []
    for line in lines:
        number, controllers, path = [*line.split(":", 2), "", ""][:3]
        if number == "0":
            root, version = CGROUPS, 2
        elif "memory" in controllers.split(","):
            root, version = CGROUPS / "memory", 1
        else:
            continue
        # In a container the path may be the one outside of it: then the root is its own group.
        own = root / path.lstrip("/")
        groups = [group for group in (own, *own.parents) if group.is_relative_to(root)]
        found += [(group, version) for group in groups if _free_in(group, version) < NO_LIMIT]
    return tuple(found)
