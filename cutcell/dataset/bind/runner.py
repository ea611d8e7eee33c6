"""A process of its own that binds one asset after the other, and may crash or hang.

`python -m cutcell.dataset.bind.runner` reads jobs from its standard input and writes results to its
standard output, both as length and pickle: the two ends are the same program. It ends with its
parent, however that ends.
"""

from __future__ import annotations

import os
import pickle
import struct
import subprocess
import sys
import tempfile
import threading
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from typing import IO, Any

from ...runtime.subprocesses import python_environment
from ..read.sources import Content
from ..read.store import Outcome, Parameters

COMMAND = (sys.executable, "-m", "cutcell.dataset.bind.runner")
LENGTH = struct.Struct("<Q")
START_LIMIT = 900.0
"""Seconds that a runner has to import and, once on a machine, to compile."""
LAST_WORDS = 2000
"""Bytes of standard error that are looked at after a crash."""


class AssetLostError(Exception):
    """A runner crashed or was too slow; the text says which, for the record of the asset.

    Parameters
    ----------
    why : str
    passing : bool
        Whether another try may do better: the process was killed from outside.
    """

    def __init__(self, why: str, passing: bool = False) -> None:
        super().__init__(why)
        self.passing = passing


class Runner:
    """One such process, started when it is first needed and again when it was lost.

    Parameters
    ----------
    threads : int
        That its kernels use.
    command : sequence of str
        What is started.
    """

    def __init__(self, threads: int = 1, command: Sequence[str] = COMMAND) -> None:
        self._threads, self._command = threads, list(command)
        self._process: subprocess.Popen | None = None
        self._errors: Any = None

    def bind(
        self,
        content: Content,
        key: str,
        parameters: Parameters,
        limit: float,
        room: Callable[[int], None] = lambda size: None,
    ) -> Outcome:
        """Bind one asset; see `work.bind_content`."""
        process = self._started()
        self._send(process, (content, key, parameters))
        needed = self._receive(process, limit, key)
        if isinstance(needed, Outcome):
            return needed
        try:
            room(needed)
        except BaseException:
            self.stop()  # it waits for its turn, which will not come
            raise
        self._send(process, None)
        return self._receive(process, limit, key)

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
        threads = {name: str(self._threads) for name in THREADS}
        self._errors = tempfile.TemporaryFile()  # noqa: SIM115
        process = subprocess.Popen(
            self._command,
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=self._errors,
            env={**python_environment(), **threads},
        )
        self._process = process
        self._receive(process, START_LIMIT, "the start")
        return process

    def _send(self, process: subprocess.Popen, message: Any) -> None:
        assert process.stdin is not None
        try:
            write(process.stdin, message)
        except OSError:
            raise self._crash(process) from None

    def _receive(self, process: subprocess.Popen, limit: float, what: str) -> Any:
        assert process.stdout is not None
        late = threading.Event()

        def end() -> None:
            late.set()
            process.kill()

        watch = threading.Timer(limit, end)
        watch.start()
        try:
            return read(process.stdout)
        except (EOFError, OSError, pickle.UnpicklingError):
            if late.is_set():
                self.stop()
                raise AssetLostError(f"it took longer than {limit:g} seconds") from None
            raise self._crash(process) from None
        finally:
            watch.cancel()

    def _crash(self, process: subprocess.Popen) -> AssetLostError:
        code = process.wait()
        self._errors.seek(0, os.SEEK_END)
        self._errors.seek(max(0, self._errors.tell() - LAST_WORDS))
        said = self._errors.read().decode("utf-8", "replace").strip().splitlines()
        self.stop()
        if code == -9:
            why = "its process was killed (signal 9); the system may have run out of memory"
            return AssetLostError(why, passing=True)
        if code < 0:
            return AssetLostError(f"its process crashed (signal {-code})")
        words = said[-1] if said else "it said nothing"
        return AssetLostError(f"its process ended with exit code {code}: {words}")


_idle: list[Runner] = []
"""Those that wait for work, in this process."""


@contextmanager
def lend_runner() -> Iterator[Runner]:
    """Lend a runner that nobody else uses."""
    try:
        runner = _idle.pop()
    except IndexError:
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


THREADS = ("NUMBA_NUM_THREADS", "OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS")


def write(pipe: IO[bytes], message: Any) -> None:
    """Write a message."""
    data = pickle.dumps(message, protocol=5)
    pipe.write(LENGTH.pack(len(data)))
    pipe.write(data)
    pipe.flush()


def read(pipe: IO[bytes]) -> Any:
    """Read a message."""
    head = pipe.read(LENGTH.size)
    if len(head) < LENGTH.size:
        raise EOFError
    (length,) = LENGTH.unpack(head)
    data = pipe.read(length)
    if len(data) < length:
        raise EOFError
    return pickle.loads(data)


def main() -> None:
    """Bind what is asked for until standard input ends."""
    answers = os.fdopen(os.dup(1), "wb")
    os.dup2(2, 1)  # what libraries print must not come among the answers
    jobs: list[Any] = []
    there = threading.Condition()

    def listen() -> None:
        try:
            while True:
                message = read(sys.stdin.buffer)
                with there:
                    jobs.append(message)
                    there.notify()
        except (EOFError, OSError):
            os._exit(0)  # whoever asked is gone, nobody wants what is under way

    def next_job() -> Any:
        with there:
            there.wait_for(lambda: jobs)
            return jobs.pop(0)

    threading.Thread(target=listen, daemon=True).start()
    from ...weights.warm_up import is_compiled, warm_up
    from .work import bind_content

    if not is_compiled():
        warm_up()
    write(answers, "ready")

    def reckoned(size: int) -> None:
        write(answers, size)
        next_job()

    while True:
        content, key, parameters = next_job()
        write(answers, bind_content(content, key, parameters, reckoned))


if __name__ == "__main__":
    main()
