"""Where compiled functions are kept, so that a machine compiles them once.

numba's own cache raises an exception where no folder can be written to, where the disk is full, and
where one of its files is empty or cut short; a file with a damaged middle ends the process ("LLVM
ERROR"). It sees changes in the function's own file only, and two processes that compile a function
for different arguments can swap their files.

Here each compiled function is a file of its own that begins with a checksum. Its name is a hash of
all that it depends on. What cannot be read is compiled again; what cannot be written stays in
memory.
"""

from __future__ import annotations

import hashlib
import logging
import os
import pickle
import shutil
import sys
from collections.abc import Callable
from contextlib import suppress
from functools import cache
from pathlib import Path
from typing import Any
from uuid import uuid4

import numba
import platformdirs
from llvmlite import binding
from numba import config
from numba.core.caching import NullCache
from numba.core.codegen import get_host_cpu_features
from numba.core.compiler import CompileResult
from numba.core.serialize import dumps

from .notebook import is_notebook
from .sources import PACKAGE, source_digest

KEPT = 3
"""How many older sets of functions are left in a folder, for other versions that use it, too."""
ANNOUNCEMENT = "Compiling, once on this machine. This takes a minute or two."
COMPLETE = "complete"
"""Name of the file that says that all functions of a binding are there."""

refusals: list[str] = []
"""Why this process could not keep what it compiled, once for each file."""


class CompileCache(NullCache):
    """The cache of one function, for numba's dispatcher.

    Parameters
    ----------
    function : callable
        Not compiled yet.
    """

    def __init__(self, function: Callable) -> None:
        code = function.__code__
        self._function = code.co_filename, function.__qualname__, code.co_firstlineno

    def load_overload(self, sig: Any, target_context: Any) -> Any:
        """Return what was compiled for some types of arguments, None if that is not to be had."""
        target_context.refresh()
        name = self._file_name(sig, target_context)
        for folder in folders() if name else ():
            with suppress(Exception):  # whatever is wrong with a file, the function can be compiled
                payload = _checked(Path(folder, name).read_bytes())
                return CompileResult._rebuild(target_context, *pickle.loads(payload))
        announce()
        return None

    def save_overload(self, sig: Any, data: Any) -> None:
        """Keep a compiled function, where that is possible."""
        can_be_kept = not data.library.has_dynamic_globals and all(x.can_cache for x in data.lifted)
        name = self._file_name(sig, data.target_context)
        if can_be_kept and name:
            payload = dumps(data._reduce())
            write(name, hashlib.sha256(payload).digest() + payload)

    def _file_name(self, sig: Any, target_context: Any) -> str:
        """Name a version of the function; empty if its source cannot be read, as in an archive."""
        source, name, line = self._function
        try:
            parts = _digest(source), name, line, sig, target_context.codegen().magic_tuple()
        except OSError:
            return ""
        return f"{name}-{hashlib.sha256(repr(parts).encode()).hexdigest()[:32]}.kernel"


def is_complete() -> bool:
    """Return whether all functions of a binding, as they now are, have been compiled and kept."""
    return any(os.path.exists(folder / COMPLETE) for folder in folders())


@cache
def announce() -> None:
    """Say, once in a process, that this machine is to compile the functions of a binding.

    It is logged; in a notebook, which shows no log of this level, it is printed, too.
    """
    if not is_complete():
        logging.getLogger("cutcell.compile").info(ANNOUNCEMENT)
        if is_notebook():
            print(ANNOUNCEMENT, file=sys.stderr)


def mark_complete() -> None:
    """Note that all functions of a binding are kept, unless one could not be.

    Older sets of functions are removed, but for a few.
    """
    folder = None if refusals else write(COMPLETE, b"")
    if folder is None:
        return
    with suppress(OSError):
        others = [path for path in folder.parent.glob("kernels-*") if path != folder]
        for old in sorted(others, key=lambda path: path.stat().st_mtime, reverse=True)[KEPT:]:
            shutil.rmtree(old, ignore_errors=True)


def write(name: str, content: bytes) -> Path | None:
    """Write a file whole into the first folder that takes it; return that, None if none does."""
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
    """List where compiled functions may be: beside the sources, or in the user's cache."""
    chosen: str = vars(config)["CACHE_DIR"]  # what NUMBA_CACHE_DIR says
    bases = [os.path.abspath(chosen)] if chosen else []
    bases.append(str(PACKAGE / "__pycache__"))
    users = platformdirs.user_cache_dir("cutcell", appauthor=False)
    if os.path.isabs(users):  # it is not without a home folder
        bases.append(users)
    return tuple(Path(base, _set_name()) for base in bases)


@cache
def _set_name() -> str:
    """Name the functions that this compiler makes of these sources for this processor."""
    compiler = sys.implementation.cache_tag, numba.__version__, binding.llvm_version_info
    processor = sys.platform, binding.get_host_cpu_name(), get_host_cpu_features()
    parts = repr((compiler, processor, source_digest(PACKAGE)))
    return f"kernels-{hashlib.sha256(parts.encode()).hexdigest()[:32]}"


@cache
def _digest(path: str) -> str:
    return hashlib.sha256(Path(path).read_bytes()).hexdigest()


def _checked(content: bytes) -> bytes:
    size = hashlib.sha256().digest_size
    if hashlib.sha256(content[size:]).digest() != content[:size]:
        raise ValueError("the file is damaged")
    return content[size:]


_set_name()  # now: the files may change while the process runs
