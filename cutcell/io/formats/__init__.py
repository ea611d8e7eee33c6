"""File formats: one module each, which is registered by being in this folder.

A module has ``SUFFIXES``, each with a pattern of how the content of such a file begins (of several
that match, the longest match counts), ``NOTE``, which lists show in brackets, and those of these
functions that the format allows:

- ``read(path, accessories, bare)`` returns a rig; if `bare`, without a skeleton that is in another
  file or part of no skin.
- ``read_skeleton(path)`` returns a `cutcell.io.skeletons.SkeletonFile`.
- ``check(path, rig)`` raises what ``write`` would raise; the rig is None if it is not known yet.
- ``write(path, rig)`` returns files by path, the one that was named last.

``--help`` lists the formats, so modules import what reads and writes in their functions.
"""

from __future__ import annotations

from importlib import import_module
from pkgutil import iter_modules
from typing import Any

FORMATS: tuple[Any, ...] = tuple(
    import_module(f"{__name__}.{module.name}") for module in iter_modules(__path__)
)
BY_SUFFIX: dict[str, Any] = {suffix: one for one in FORMATS for suffix in one.SUFFIXES}


def suffixes(function: str) -> tuple[str, ...]:
    """Return the suffixes of the formats that have a function, such as "write"."""
    return tuple(suffix for suffix, one in BY_SUFFIX.items() if hasattr(one, function))


def described(function: str) -> str:
    """Return what `suffixes` does, in words."""
    formats = [one for one in FORMATS if hasattr(one, function)]
    return "; ".join(
        ", ".join(one.SUFFIXES) + (f" ({one.NOTE})" if one.NOTE else "") for one in formats
    )
