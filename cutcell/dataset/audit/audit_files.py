"""An audit as files: pairs, clusters, what to keep, and what a person said of pairs."""

from __future__ import annotations

import json
from collections.abc import Iterable, Sequence
from dataclasses import fields
from pathlib import Path
from typing import Any

from ...errors import FileError
from ...io.files import read_bytes
from ...runtime.writing import write_all
from ..read.sources import find_sources
from ..read.store import read_table, table_bytes
from .duplicates import DIFFERENT, DUPLICATE, Audit, Pair
from .likeness import Likeness

AUDIT, PAIRS, CLUSTERS, VERDICTS = (
    "audit.json",
    "pairs.parquet",
    "clusters.parquet",
    "verdicts.json",
)
AGAIN = "audit it again: cutcell dataset audit"


def save_audit(
    found: Audit, folder: Path, first: Sequence[Path] = (), second: Sequence[Path] = ()
) -> None:
    """Write an audit to a folder.

    `audit.json` and `clusters.parquet` tell what to keep, `pairs.parquet` lists all pairs, and
    `verdicts.json` what a person said of some of them.

    Parameters
    ----------
    found : Audit
    folder : Path
    first, second : sequence of Path
        What was compared, for `load_audit`.

    Raises
    ------
    FileError
        They cannot be written.
    MissingLibraryError
        pyarrow or scikit-learn is not installed.
    """
    inputs = [[str(path.resolve()) for path in paths] for paths in (first, second)]
    more = {"inputs": inputs, "threshold": found.threshold, "least": found.least}
    write_all({folder / PAIRS: table_bytes(found.rows()), **_contents(found, folder, more)})


def save_verdicts(found: Audit, folder: Path) -> None:
    """Write what a person said of pairs, and what is kept then, beside an audit that is there.

    Raises
    ------
    FileError
        They cannot be written, or there is no audit.
    MissingLibraryError
        pyarrow or scikit-learn is not installed.
    """
    before = _document(folder / AUDIT)
    more = {name: before[name] for name in ("inputs", "threshold", "least")}
    write_all(_contents(found, folder, more))


def _contents(found: Audit, folder: Path, more: dict[str, Any]) -> dict[Path, bytes]:
    kept = set(found.keep)
    labels = [None] * len(found.names) if found.labels is None else found.labels.tolist()
    assets = [
        {"name": name, "cluster": label, "keep": name in kept}
        for name, label in zip(found.names, labels, strict=True)
    ]
    said = [{"a": a, "b": b, "verdict": verdict} for (a, b), verdict in found.verdicts.items()]
    return {
        folder / CLUSTERS: table_bytes(assets),
        folder / AUDIT: _json({**found.to_dict(), **more}),
        folder / VERDICTS: _json(said),
    }


def _json(value: Any) -> bytes:
    return json.dumps(value, indent=1).encode("utf-8", "replace") + b"\n"


def read_verdicts(folder: Path) -> dict[tuple[str, str], str]:
    """Return what a person said of the pairs of an audit; nothing where there is none."""
    path = folder / VERDICTS
    if not path.exists():
        return {}
    try:
        said = {(row["a"], row["b"]): row["verdict"] for row in _document(path)}
    except (TypeError, KeyError):
        said = {("", ""): ""}
    if not set(said.values()) <= {DUPLICATE, DIFFERENT}:
        raise FileError(
            f'{path}: must be a list of {{"a": name, "b": name, "verdict": "{DUPLICATE}" or '
            f'"{DIFFERENT}"}}; put it right, or remove it'
        )
    return said


def load_audit(folder: Path) -> Audit:
    """Return an audit that was saved, with the characters that it was made of.

    Raises
    ------
    FileError
        There is no audit, or its characters are no longer where they were.
    MissingLibraryError
        pyarrow is not installed.
    """
    document = _document(folder / AUDIT)
    try:
        first, second = ([Path(path) for path in paths] for paths in document["inputs"])
        counts = document["candidates"], document["failed"]
        figures = document["seconds"], document["threshold"], document["least"]
    except (TypeError, KeyError, ValueError):
        raise FileError(f"{folder / AUDIT}: does not say what it was made of; {AGAIN}") from None
    left_out = set(counts[1])
    ours = [source for source in find_sources(first) if source.name not in left_out]
    theirs = ours
    if second:
        theirs = [source for source in find_sources(second) if source.name not in left_out]
    names = [source.name for source in ours], [source.name for source in theirs]
    pairs = list(_pairs(read_table(folder / PAIRS), *names, folder))
    near = [pair for tier, pair in pairs if tier != "posed"]
    posed = [pair for tier, pair in pairs if tier == "posed"]
    said = read_verdicts(folder)
    return Audit(*names, near, posed, *counts, ours, theirs, *figures, said)


def _pairs(
    rows: Iterable[dict[str, Any]], names: list[str], others: list[str], folder: Path
) -> Iterable[tuple[str, Pair]]:
    place = {name: k for k, name in enumerate(names)}
    other = {name: k for k, name in enumerate(others)}
    figures = [field.name for field in fields(Likeness)]
    for row in rows:
        try:
            ends = place[row["a"]], other[row["b"]]
            alike = Likeness(**{name: row[name] for name in figures})
            yield row["tier"], Pair(*ends, row["joints"], row["surface"], alike)
        except KeyError as missing:
            raise FileError(
                f"{folder}: the characters have changed since this audit (there is no {missing}); "
                f"{AGAIN}"
            ) from None


def _document(path: Path) -> Any:
    data = read_bytes(path)
    try:
        return json.loads(data)
    except (ValueError, RecursionError):
        raise FileError(f"{path}: is no JSON; {AGAIN}") from None
