"""File formats: one module each, which is registered by being in this folder.

A module has ``SUFFIXES``, each with a pattern of how the content of such a file begins (of several
that match, the longest match counts), ``NOTE``, which lists show in brackets, and those of these
functions that the format allows:

- ``read(path, accessories, bare)`` returns a rig; if `bare`, without a skeleton that is in another
  file or part of no skin.
- ``read_skeleton(path)`` returns a `cutcell.io.skeletons.SkeletonFile`.
- ``check(path, rig)`` raises what ``write`` would raise, whatever the weights will be.
- ``write(path, rig)`` returns files by path, the one that was named last.
"""

from __future__ import annotations

import ast
from dataclasses import dataclass
from importlib import import_module
from pathlib import Path
from typing import Any


@dataclass(frozen=True)
class Format:
    """What a module says of itself; it is imported when it is used."""

    name: str
    suffixes: dict[str, bytes]
    note: str
    functions: frozenset[str]

    @property
    def module(self) -> Any:
        """The module, whose libraries `--help` does not wait for."""
        return import_module(f"{__name__}.{self.name}")


def _declared(path: Path) -> Format:
    """Return a format as its module declares it by literals."""
    body = ast.parse(path.read_text(encoding="utf-8")).body
    literals = {
        node.targets[0].id: ast.literal_eval(node.value)
        for node in body
        if isinstance(node, ast.Assign)
        and isinstance(node.targets[0], ast.Name)
        and node.targets[0].id in ("SUFFIXES", "NOTE")
    }
    functions = frozenset(node.name for node in body if isinstance(node, ast.FunctionDef))
    return Format(path.stem, literals["SUFFIXES"], literals["NOTE"], functions)


FORMATS = tuple(
    _declared(path)
    for path in sorted(Path(__file__).parent.glob("*.py"))
    if path.stem != "__init__"
)
BY_SUFFIX = {suffix: one for one in FORMATS for suffix in one.suffixes}
GLTF = tuple(BY_SUFFIX[".glb"].suffixes)


def suffixes(function: str) -> tuple[str, ...]:
    """Return the suffixes of the formats that have a function, such as "write"."""
    return tuple(suffix for suffix, one in BY_SUFFIX.items() if function in one.functions)


def described(function: str) -> str:
    """Return what `suffixes` does, in words."""
    formats = [one for one in FORMATS if function in one.functions]
    return "; ".join(
        ", ".join(one.suffixes) + (f" ({one.note})" if one.note else "") for one in formats
    )
