"""Subprocess that binds one asset after another, and may crash or hang.

`python -m cutcell_lab.dataset.bind.runner` reads pickled jobs from standard input and writes
pickled results to standard output. It ends with its parent, however the parent ends.
"""

from __future__ import annotations

import os
import pickle
import subprocess
import sys
import tempfile
import threading
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from queue import SimpleQueue
from typing import IO, Any

from cutcell.runtime.subprocesses import python_environment

from ..read.sources import Content
from ..read.store import Outcome, Parameters

COMMAND = (sys.executable, "-m", "cutcell_lab.dataset.bind.runner")
THREADS = ("NUMBA_NUM_THREADS", "OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS")
START_LIMIT = 900.0
"""Seconds for the imports and, once per machine, for compilation."""
STDERR_TAIL = 2000
"""Bytes of standard error that are searched for a message after a crash."""


class AssetLostError(Exception):
    """A runner crashed or was too slow; `passing` if another attempt may succeed."""

    def __init__(self, why: str, passing: bool = False) -> None:
        super().__init__(why)
        self.passing = passing


class Runner:
    """One such process with one thread, started when needed and again after a loss."""

    def __init__(self, command: Sequence[str] = COMMAND) -> None:
        self._command = list(command)
        self._process: subprocess.Popen | None = None
        self._errors: Any = None

    def bind(
        self,
        content: Content,
        key: str,
        parameters: Parameters,
        limit: float,
        reserve: Callable[[int], None] = lambda size: None,
    ) -> Outcome:
        """Bind one asset; see `work.bind_content`."""
        process = self._started()
        self._send(process, (content, key, parameters))
        needed = self._receive(process, limit)
        if isinstance(needed, Outcome):
            return needed
        try:
            reserve(needed)
        except BaseException:
            self.stop()  # it waits for memory in vain
            raise
        self._send(process, None)
        return self._receive(process, limit)

    def stop(self) -> None:
        """End the process."""
        process, self._process = self._process, None
        if process is not None:
            process.kill()
            process.wait()
            for pipe in (process.stdin, process.stdout):
                if pipe is not None:
                    pipe.close()
            self._errors.close()

    def _started(self) -> subprocess.Popen:
        if self._process is not None and self._process.poll() is None:
            return self._process
        self.stop()
        self._errors = tempfile.TemporaryFile()  # noqa: SIM115
        process = subprocess.Popen(
            self._command,
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=self._errors,
            env={**python_environment(), **dict.fromkeys(THREADS, "1")},
        )
        self._process = process
        self._receive(process, START_LIMIT)
        return process

    def _send(self, process: subprocess.Popen, message: Any) -> None:
        assert process.stdin is not None
        try:
            write(process.stdin, message)
        except OSError:
            raise self._crash(process) from None

    def _receive(self, process: subprocess.Popen, limit: float) -> Any:
        assert process.stdout is not None
        is_late = threading.Event()

        def end() -> None:
            is_late.set()
            process.kill()

        timer = threading.Timer(limit, end)
        timer.start()
        try:
            return pickle.load(process.stdout)
        except (EOFError, OSError, pickle.UnpicklingError):
            if is_late.is_set():
                self.stop()
                raise AssetLostError(f"it took longer than {limit:g} seconds") from None
            raise self._crash(process) from None
        finally:
            timer.cancel()

    def _crash(self, process: subprocess.Popen) -> AssetLostError:
        code = process.wait()
        self._errors.seek(0, os.SEEK_END)
        self._errors.seek(max(0, self._errors.tell() - STDERR_TAIL))
        output = self._errors.read().decode("utf-8", "replace").strip().splitlines()
        self.stop()
        if code == -9:
            why = "its process was killed (signal 9); the system may have run out of memory"
            return AssetLostError(why, passing=True)
        if code < 0:
            return AssetLostError(f"its process crashed (signal {-code})")
        message = output[-1] if output else "no message"
        return AssetLostError(f"its process ended with exit code {code}: {message}")


_idle: list[Runner] = []
"""Runners of this process that wait for work."""


@contextmanager
def lend_runner() -> Iterator[Runner]:
    """Yield a runner for exclusive use."""
    try:
        runner = _idle.pop()
    except IndexError:  # checking the length first would race with other threads
        runner = Runner()
    try:
        yield runner
    finally:
        _idle.append(runner)


def stop_runners() -> None:
    """End the processes that wait for work."""
    while _idle:
        _idle.pop().stop()


def cores() -> int:
    """Return how many cores this process may use."""
    try:
        return len(os.sched_getaffinity(0))
    except AttributeError:
        return os.cpu_count() or 1


def write(pipe: IO[bytes], message: Any) -> None:
    """Write a message."""
    pickle.dump(message, pipe, protocol=5)
    pipe.flush()


def main() -> None:
    """Bind the assets that are sent to standard input until it ends."""
    results = os.fdopen(os.dup(1), "wb")
    os.dup2(2, 1)  # output of libraries must not mix with the results
    messages: SimpleQueue[Any] = SimpleQueue()

    def listen() -> None:
        try:
            while True:
                messages.put(pickle.load(sys.stdin.buffer))
        except (EOFError, OSError, pickle.UnpicklingError):
            os._exit(0)  # the parent is gone, and nothing needs the current result

    threading.Thread(target=listen, daemon=True).start()
    from cutcell.weights.warm_up import is_compiled, warm_up

    from .work import bind_content

    if not is_compiled():
        warm_up()
    write(results, "ready")

    def wait_for_memory(size: int) -> None:
        write(results, size)
        messages.get()

    while True:
        content, key, parameters = messages.get()
        write(results, bind_content(content, key, parameters, wait_for_memory))


if __name__ == "__main__":
    main()
