"""Pairs of a predicted and a reference rig, in files that have the same names."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from cutcell.errors import FileError
from cutcell.runtime.display import listed

from ..dataset.read.sources import Source, find_sources

ARRAY = ".npy"
"""Ending of files that hold weights alone."""


@dataclass(frozen=True)
class Pair:
    """A prediction and its reference."""

    name: str
    predicted: Source
    reference: Source


@dataclass(frozen=True)
class Pairs:
    """All pairs, and the names that only one side has."""

    pairs: tuple[Pair, ...]
    predicted_only: tuple[str, ...]
    reference_only: tuple[str, ...]


def find_pairs(predicted: Path, reference: Path) -> Pairs:
    """Pair the rigs of two files, whatever their names, or those of two folders by name.

    Names are paths in the folder without ending. Where they differ, file names that occur once on
    each side are paired.

    Raises
    ------
    FileError
        A path without rigs, or no names in common.
    """
    left, right = _predictions(predicted), find_sources([reference])
    if len(left) == len(right) == 1 and predicted.is_file() and reference.is_file():
        return Pairs((Pair(right[0].name, left[0], right[0]),), (), ())
    by_path = {source.name: source for source in left}
    matches = {source.name: by_path[source.name] for source in right if source.name in by_path}
    matched = set(matches)
    rest = [source for source in left if source.name not in matched]
    by_file = _by_file_name(rest)
    for file_name, source in _by_file_name([s for s in right if s.name not in matches]).items():
        if file_name in by_file:
            matches[source.name] = by_file[file_name]
            matched.add(by_file[file_name].name)
    predicted_only = tuple(source.name for source in left if source.name not in matched)
    reference_only = tuple(source.name for source in right if source.name not in matches)
    if not matches:
        raise FileError(
            f"{predicted}: no file has the name of one in {reference}. It has "
            f"{listed(predicted_only)}; the reference has {listed(reference_only)}. Give matching "
            "files the same name; endings may differ"
        )
    pairs = tuple(
        Pair(source.name, matches[source.name], source)
        for source in right
        if source.name in matches
    )
    return Pairs(pairs, predicted_only, reference_only)


def _predictions(path: Path) -> list[Source]:
    """List the rigs of a file or folder, or its arrays of weights where it has no rigs."""
    if path.suffix.lower() == ARRAY and path.is_file():
        return [Source(path.stem, path, "weights")]
    arrays = sorted(path.rglob(f"*{ARRAY}")) if path.is_dir() else []
    try:
        return find_sources([path])
    except FileError:
        if not arrays:
            raise
    return [
        Source(array.relative_to(path).with_suffix("").as_posix(), array, "weights")
        for array in arrays
    ]


def _by_file_name(sources: Sequence[Source]) -> dict[str, Source]:
    """Return the sources whose file name no other one has."""
    names = [source.name.rpartition("/")[2] for source in sources]
    counts = Counter(names)
    pairs = zip(names, sources, strict=True)
    return {name: source for name, source in pairs if counts[name] == 1}
