"""How other processes of the same Python are started."""

import os
import sys
from contextlib import suppress
from pathlib import Path


def python_environment() -> dict[str, str]:
    """Return an environment in which another Python finds the packages that this one does.

    Files in its working folder replace none of them.
    """
    path = os.pathsep.join(filter(None, sys.path))
    return {**os.environ, "PYTHONPATH": path, "PYTHONSAFEPATH": "1"}


def end_first_without_memory() -> None:
    """Make Linux end this process, not its parent, when memory runs out."""
    with suppress(OSError):
        Path("/proc/self/oom_score_adj").write_text("1000")
