"""Work in another process, which is ended when the result is no longer wanted.

A reader of files need not look whether it is still wanted, may hold Python's lock for as long as it
likes, and may crash: no page waits for it, and none is harmed.
"""

import math
import multiprocessing
import os
import pickle
import signal
import threading
import time
import traceback
from collections.abc import Callable
from contextlib import suppress
from multiprocessing.connection import Connection, wait
from pathlib import Path
from typing import Any, TypeVar

from cutcell.errors import FileError
from cutcell.runtime.subprocesses import end_first_without_memory

Result = TypeVar("Result")

MAX_SECONDS = 300.0
"""How long reading a file may take: one that never ends would keep all others waiting."""

ASK_EVERY = 0.05
"""Seconds between two questions whether the result is still wanted."""

LONGEST_FOLDER = 80
"""Bytes of a folder's path to which the name of a socket can be added."""

# A server of processes is started once, with what they need; each then takes some milliseconds.
# Each also imports the main module of this process: for commands, `cutcell.cli.app`.
_METHOD = "forkserver" if "forkserver" in multiprocessing.get_all_start_methods() else "spawn"
_CONTEXT: Any = multiprocessing.get_context(_METHOD)
if _METHOD == "forkserver":
    _CONTEXT.set_forkserver_preload(["cutcell.cli.app", "cutcell.io", __name__])


def get_ready(make_folder: Callable[[], Path]) -> None:
    """Start what processes are started by, before the first is needed.

    `make_folder` makes a folder for its socket. The one that Python makes itself stays for ever
    where this process is killed.
    """
    if _METHOD == "forkserver":
        from multiprocessing.forkserver import ensure_running

        with suppress(OSError):
            folder = str(make_folder())
            if len(os.fsencode(folder)) <= LONGEST_FOLDER:
                multiprocessing.current_process()._config["tempdir"] = folder  # type: ignore[attr-defined]
        # Nothing in the folder that the page is started in takes the place of a library.
        os.environ["PYTHONSAFEPATH"] = "1"
        ensure_running()


def in_process(
    work: Callable[..., Result],
    *args: Any,
    check: Callable[[], object] = lambda: None,
    ended: str = "it came to a sudden end",
    limit: float = math.inf,
) -> Result:
    """Call a function in another process; return its result.

    Parameters
    ----------
    work : callable
        Of a module; what it is given and what it returns are copied.
    *args
        Its arguments.
    check : callable
        Called again and again; raises `cutcell.Cancelled` for one, when the result is not wanted
        any more: the process, and those that it has started, are ended then.
    ended : str
        What to say if the process comes to an end by itself.
    limit : float
        Seconds after which the process is ended.

    Raises
    ------
    FileError
        The process came to an end by itself, or took longer than `limit`.
    Exception
        Whatever `work` or `check` raises.
    """
    latest = time.monotonic() + limit
    receiver, sender = _CONTEXT.Pipe(duplex=False)
    process = _CONTEXT.Process(target=_run, args=(sender, work, args), daemon=True)
    with receiver:
        try:
            process.start()
            sender.close()
            while not receiver.poll(ASK_EVERY):
                check()
                if time.monotonic() > latest:
                    raise FileError(f"reading it took longer than {limit:g} seconds")
            good, outcome = pickle.loads(receiver.recv_bytes())
        except (EOFError, ConnectionError):
            raise FileError(f"{ended} ({_ending(process)})") from None
        finally:
            _end(process)
    if not good:
        raise outcome
    return outcome  # type: ignore[no-any-return]


def _run(pipe: Connection, work: Callable[..., Any], args: tuple[Any, ...]) -> None:
    """Do the work, in the other process, and send what comes of it."""
    if hasattr(os, "setsid"):
        os.setsid()  # so that it can be ended together with what it starts
    threading.Thread(target=_end_with_parent, daemon=True).start()
    end_first_without_memory()
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    try:
        outcome = pickle.dumps((True, work(*args)), 5)
    except Exception as error:
        outcome = _packed(error)
    pipe.send_bytes(outcome)


def _end_with_parent() -> None:
    """End this process and its children when the waiting process was killed."""
    parent = multiprocessing.parent_process()
    if parent is not None:
        wait([parent.sentinel])
        if hasattr(os, "killpg"):
            os.killpg(0, signal.SIGKILL)
        os._exit(1)


def _packed(error: Exception) -> bytes:
    error.add_note(traceback.format_exc())
    try:
        packed = pickle.dumps((False, error), 5)
        pickle.loads(packed)
    except Exception:  # not every error can be copied
        packed = pickle.dumps((False, RuntimeError(f"{type(error).__name__}: {error}")), 5)
    return packed


def _end(process: Any) -> None:
    if process.pid is None:
        return
    if process.is_alive():
        with suppress(ProcessLookupError, PermissionError):
            if hasattr(os, "killpg"):
                os.killpg(process.pid, signal.SIGKILL)
        process.kill()
    process.join()


def _ending(process: Any) -> str:
    if process.pid is None:
        return "no process could begin"
    process.join()
    code = process.exitcode
    return f"signal {-code}" if code is not None and code < 0 else f"exit code {code}"
