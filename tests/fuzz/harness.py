"""Try many numbered cases in processes of their own, within limits of memory and time.

A fuzzer is a module with a function `check(number)`: it makes a case from the number and raises
whatever is wrong with it. Its processes are used again until one dies, so that what is slow
to start (imports, compiled kernels) is paid for once; `warm_up()`, if the module has it, is called
before the limits begin to count.
"""

from __future__ import annotations

import argparse
import json
import os
import queue
import re
import resource
import signal
import subprocess
import sys
import threading
import time
import traceback
from collections.abc import Iterable
from contextlib import suppress
from dataclasses import dataclass
from importlib import import_module
from pathlib import Path
from types import ModuleType
from typing import TextIO

from tests.signals import reset_signals

ROOT = Path(__file__).resolve().parents[2]
SECONDS = 10
"""That a case may take."""
MEMORY = 2 * 2**30
"""Bytes that a process may have in memory."""


@dataclass(frozen=True)
class Failure:
    """What is wrong with a case."""

    number: int
    why: str


@dataclass(frozen=True)
class Report:
    """What came of some cases.

    Parameters
    ----------
    passed : int
    failures : list of Failure
    slowest : (float, int)
        Seconds of the slowest case, and its number.
    peak : int
        Bytes that the largest process had in memory.
    """

    passed: int
    failures: list[Failure]
    slowest: tuple[float, int]
    peak: int


def try_cases(
    module: str, numbers: Iterable[int], processes: int = 2, seconds: int = SECONDS
) -> Report:
    """Check cases in several processes.

    Parameters
    ----------
    module : str
        Name of the module with `check`.
    numbers : iterable of int
        Of the cases.
    processes : int
    seconds : int
        Of processor time that a case may take, in all threads, and four times as much by the clock:
        other work on the machine is not held against it.
    """
    waiting: queue.SimpleQueue[int] = queue.SimpleQueue()
    for number in numbers:
        waiting.put(number)
    results: list[dict] = []
    threads = [
        threading.Thread(target=_feed, args=(module, waiting, results, seconds))
        for _ in range(processes)
    ]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    failures = [Failure(r["number"], r["why"]) for r in results if r["why"]]
    slowest = max(((r["seconds"], r["number"]) for r in results if not r["why"]), default=(0.0, -1))
    return Report(
        passed=len(results) - len(failures),
        failures=sorted(failures, key=lambda failure: failure.number),
        slowest=slowest,
        peak=max((r["peak"] for r in results), default=0),
    )


def _feed(module: str, waiting: queue.SimpleQueue[int], results: list[dict], seconds: int) -> None:
    """Let one process after the other check what waits, each until it dies."""
    while not waiting.empty():
        command = [sys.executable, "-m", "tests.fuzz.harness", module, str(seconds)]
        with subprocess.Popen(
            command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True, cwd=ROOT
        ) as process:
            assert process.stdin is not None
            assert process.stdout is not None
            while True:
                try:
                    number = waiting.get_nowait()
                except queue.Empty:
                    process.stdin.close()
                    return
                with suppress(BrokenPipeError):
                    process.stdin.write(f"{number}\n")
                    process.stdin.flush()
                answer = process.stdout.readline()
                if not answer:
                    process.wait()
                    results.append(_death(number, process.returncode, seconds))
                    break
                results.append(json.loads(answer))


def _death(number: int, code: int, seconds: int) -> dict:
    why = f"the process ended with code {code}"
    if code < 0:
        why = f"the process died of {signal.Signals(-code).name}"
    if code in (-signal.SIGALRM, -signal.SIGXCPU):
        why = f"it took longer than {seconds} s"
    return {"number": number, "why": why, "seconds": float(seconds), "peak": 0}


def serve(module: str, seconds: int) -> None:
    """Check the cases whose numbers come in by standard input; answer each on standard output."""
    reset_signals()
    with os.fdopen(os.dup(1), "w") as answers:
        os.dup2(2, 1)  # whatever is printed is no answer
        fuzzer = import_module(module)
        getattr(fuzzer, "warm_up", lambda: None)()
        _limit_memory()
        _answer(fuzzer, seconds, answers)


def _answer(fuzzer: ModuleType, seconds: int, answers: TextIO) -> None:
    for line in sys.stdin:
        number, why = int(line), ""
        begin = time.process_time()
        _limit_time(seconds)
        try:
            fuzzer.check(number)
        except BaseException:
            why = traceback.format_exc()
        signal.alarm(0)
        answer = {
            "number": number,
            "why": why,
            "seconds": time.process_time() - begin,
            "peak": _peak(),
        }
        answers.write(json.dumps(answer) + "\n")
        answers.flush()


def _peak() -> int:
    """Return the most memory that the process had; what rusage tells holds its parent's as well."""
    status = Path("/proc/self/status").read_text()
    (kilobytes,) = re.findall(r"VmHWM:\s+(\d+) kB", status)
    return int(kilobytes) * 1024


def _limit_memory() -> None:
    """Let the process take what is left to it; of addresses it has more than of memory."""
    pages = Path("/proc/self/statm").read_text().split()
    addresses, resident = (int(count) * resource.getpagesize() for count in pages[:2])
    most = addresses + max(MEMORY - resident, 0)
    resource.setrlimit(resource.RLIMIT_AS, (most, most))


def _limit_time(seconds: int) -> None:
    """Have the process end after so much processor time, or four times as much by the clock."""
    used = resource.getrusage(resource.RUSAGE_SELF)
    soon = int(used.ru_utime + used.ru_stime) + seconds + 1
    resource.setrlimit(resource.RLIMIT_CPU, (soon, resource.RLIM_INFINITY))
    signal.alarm(4 * seconds)


def main(module: str) -> None:
    """Run a fuzzer by the command line."""
    parser = argparse.ArgumentParser(prog=f"python -m {module}")
    parser.add_argument("--count", type=int, default=100, help="how many cases")
    parser.add_argument("--first", type=int, default=0, help="the number of the first")
    parser.add_argument("--case", type=int, help="this one alone, here, without limits")
    parser.add_argument("--processes", type=int, default=os.cpu_count() or 1)
    options = parser.parse_args()
    if options.case is not None:
        fuzzer = import_module(module)
        print(fuzzer.describe(options.case))
        fuzzer.check(options.case)
        return
    numbers = range(options.first, options.first + options.count)
    report = try_cases(module, numbers, options.processes)
    for failure in report.failures:
        print(f"case {failure.number} (python -m {module} --case {failure.number}):")
        print(failure.why)
    print(
        f"{report.passed:,} of {options.count:,} cases passed; the slowest took "
        f"{report.slowest[0]:.1f} s (case {report.slowest[1]}), the largest process "
        f"{report.peak / 1e9:.2f} GB"
    )
    sys.exit(bool(report.failures))


if __name__ == "__main__":
    serve(sys.argv[1], int(sys.argv[2]))
