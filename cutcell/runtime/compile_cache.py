"""Cache of compiled functions, so that a machine compiles them once.

numba's own cache raises where no folder can be written to, where the disk is full, and where a file
is cut short; it cannot be read where it cannot be written; and two processes that compile a
function can swap its files. Here each compiled function is one compressed file with a checksum,
written whole. It is named by a hash of all that it depends on: every source of cutcell, and of the
package that the function is in, Python, numba and the processor. What cannot be read is compiled
again; what cannot be written stays in memory.
"""

from __future__ import annotations

import hashlib
import logging
import os
import pickle
import shutil
import sys
import time
import zlib
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager, suppress
from functools import cache
from pathlib import Path
from typing import IO, Any
from uuid import uuid4

import numba
import platformdirs
from llvmlite import binding
from numba import config
from numba.core.compiler import CompileResult
from numba.core.serialize import dumps

from .notebook import is_notebook
from .sources import PACKAGE, source_digest

try:
    import fcntl
except ImportError:  # on Windows
    fcntl = None  # type: ignore[assignment]

MAX_OLD_SETS = 3
"""Older sets of functions that stay in a folder, for other versions that use it, too."""
ANNOUNCEMENT = "Compiling, once on this machine. This takes about half a minute."
COMPLETE, LOCK = "complete", "lock"
"""Names of the file that marks a set with all functions of a binding, and of the file that a
process locks while it compiles them."""
PATIENCE, LOOK_EVERY = 120.0, 0.02
"""Seconds to wait for a process that compiles, and between two looks at it."""

refusals: list[str] = []
"""Why this process could not keep what it compiled, one entry per file."""


class CompileCache:
    """Cache of one function, for numba's dispatcher.

    Parameters
    ----------
    function : callable
        Not compiled yet.
    """

    cache_path = None  # the dispatcher's `stats` read it

    def __init__(self, function: Callable) -> None:
        self._function = function

    def load_overload(self, sig: Any, target_context: Any) -> Any:
        """Return what was compiled for some types of arguments, None if that is not available."""
        target_context.refresh()
        name = self._file_name(sig)
        for folder in folders() if name else ():
            with suppress(Exception):  # whatever is wrong with a file, the function can be compiled
                payload = zlib.decompress((folder / name).read_bytes())
                return CompileResult._rebuild(target_context, *pickle.loads(payload))
        announce()
        return None

    def save_overload(self, sig: Any, data: Any) -> None:
        """Keep a compiled function, where that is possible."""
        name = self._file_name(sig)
        if name and not data.library.has_dynamic_globals:
            write(name, zlib.compress(dumps(data._reduce()), 1))

    def _file_name(self, sig: Any) -> str:
        """Name a version of the function; empty if its sources cannot be read."""
        function, code = self._function, self._function.__code__
        package = sys.modules.get((function.__module__ or "").partition(".")[0])
        file = getattr(package, "__file__", None) or ""
        try:
            is_package = file.endswith("__init__.py")
            digest = source_digest(Path(file).parent if is_package else Path(code.co_filename))
        except OSError:
            return ""
        parts = digest, function.__module__, code.co_firstlineno, sig
        digest = hashlib.sha256(repr(parts).encode()).hexdigest()[:32]
        return f"{function.__qualname__}-{digest}.kernel"


@contextmanager
def only_process() -> Iterator[None]:
    """Wait for another process that is in this block, so that this one loads what it compiles.

    Where no file can be locked, both compile.
    """
    with ExitStack() as stack:
        for folder in folders() if fcntl else ():
            with suppress(OSError):
                folder.mkdir(parents=True, exist_ok=True)
                _lock(stack.enter_context((folder / LOCK).open("ab")))
                break
        yield


def _lock(file: IO[bytes]) -> None:
    """Lock a file, until it is closed, as soon as no other process does, or `PATIENCE` ends."""
    end = time.monotonic() + PATIENCE
    while time.monotonic() < end:
        try:
            return fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            time.sleep(LOOK_EVERY)
    return None


def is_complete() -> bool:
    """Return whether all functions of a binding are in the cache, or none is to be compiled."""
    is_off = bool(vars(config)["DISABLE_JIT"])
    return is_off or any(os.path.exists(folder / COMPLETE) for folder in folders())


@cache
def announce() -> None:
    """Announce, once per process, that functions are compiled: in the log and in notebooks."""
    if not is_complete():
        logging.getLogger("cutcell.compile").info(ANNOUNCEMENT)
        if is_notebook():
            print(ANNOUNCEMENT, file=sys.stderr)


def mark_complete() -> None:
    """Record that all functions of a binding are kept, unless one could not be.

    All but a few older sets of functions are removed.
    """
    folder = None if refusals else write(COMPLETE, b"")
    if folder is None:
        return
    with suppress(OSError):
        others = [path for path in folder.parent.glob("kernels-*") if path != folder]
        others.sort(key=lambda path: path.stat().st_mtime, reverse=True)
        for old in others[MAX_OLD_SETS:]:
            shutil.rmtree(old, ignore_errors=True)


def write(name: str, content: bytes) -> Path | None:
    """Write a whole file into the first writable folder; return the folder, or None."""
    why = "no folder to keep them in is known"
    for folder in folders():
        try:
            _write(folder, name, content)
            return folder
        except OSError as error:
            why = f"{folder.parent}: {error.strerror or error}"
    refusals.append(why)
    return None


def _write(folder: Path, name: str, content: bytes) -> None:
    folder.mkdir(parents=True, exist_ok=True)
    unready = folder / f"{uuid4().hex}.unready"
    try:
        unready.write_bytes(content)
        unready.replace(folder / name)
    except OSError:
        with suppress(OSError):
            unready.unlink()
        raise


@cache
def folders() -> tuple[Path, ...]:
    """List the folders of compiled functions: next to the sources, and in the user's cache."""
    chosen: str = vars(config)["CACHE_DIR"]  # the value of NUMBA_CACHE_DIR
    bases = [os.path.abspath(chosen)] if chosen else []
    bases.append(str(PACKAGE / "__pycache__"))
    with suppress(RuntimeError):  # for a user without a home folder
        users = platformdirs.user_cache_dir("cutcell", appauthor=False)
        if os.path.isabs(users):  # older versions return a relative path then
            bases.append(users)
    return tuple(Path(base, _set_name()) for base in bases)


@cache
def _set_name() -> str:
    """Name the set of functions by compiler, processor and sources.

    With NUMBA_CPU_NAME=generic they run on all processors of a kind, as those of a container must.
    """
    compiler = sys.implementation.cache_tag, numba.__version__, binding.llvm_version_info
    name, features = vars(config)["CPU_NAME"], vars(config)["CPU_FEATURES"]
    features = binding.get_host_cpu_features().flatten() if features is None else features
    processor = sys.platform, name or binding.get_host_cpu_name(), features
    parts = repr((compiler, processor, source_digest(PACKAGE)))
    return f"kernels-{hashlib.sha256(parts.encode()).hexdigest()[:32]}"


_set_name()  # now: the files may change while the process runs
