"""Read a job, do it, write its result: arrays by name, or in `failed` why there are none.

Where a library is not installed, `missing` is its name.

The result also tells the `seconds` that the task took, the process's start left out.
"""

from __future__ import annotations

import os
import sys
from importlib import import_module
from pathlib import Path
from time import perf_counter

import numpy as np


def main(task: str, job_path: str, result_path: str, memory: str = "0") -> None:
    """Call a function, named as "module:function", with the arrays of the job."""
    module, function = task.split(":")
    limit_memory(int(memory))
    with np.load(job_path) as job:
        arrays = {name: job[name] for name in job.files}
    begin = perf_counter()
    try:
        result = getattr(import_module(module), function)(**arrays)
    except ModuleNotFoundError as error:
        result = {"missing": str(error.name)}
    except (RuntimeError, ValueError, MemoryError) as error:
        result = {"failed": str(error) or type(error).__name__}
    np.savez(result_path, **result, seconds=perf_counter() - begin)


def limit_memory(allowance: int) -> None:
    """Limit the further memory of this process on Linux, if not 0; a lower limit stays."""
    try:
        import resource

        pages = int(Path("/proc/self/statm").read_text().split()[0])
    except (ImportError, OSError):
        return
    if allowance:
        soft, hard = resource.getrlimit(resource.RLIMIT_AS)
        most = pages * resource.getpagesize() + allowance
        if soft != resource.RLIM_INFINITY:
            most = min(most, soft)
        resource.setrlimit(resource.RLIMIT_AS, (most, hard))


if __name__ == "__main__":
    main(*sys.argv[1:])
    os._exit(0)  # the result is written; some libraries crash as they are taken down
