"""Files of an audit: pairs, clusters, assets to keep, and verdicts on pairs."""

from __future__ import annotations

import json
from collections.abc import Iterable, Sequence
from dataclasses import fields
from pathlib import Path
from typing import Any

from cutcell.errors import FileError
from cutcell.io.files import read_bytes
from cutcell.runtime.writing import write_all

from ..read.sources import find_sources
from ..read.store import read_table, table_bytes
from .duplicates import DIFFERENT, DUPLICATE, Audit, Pair
from .likeness import Similarity

AUDIT, PAIRS, CLUSTERS, VERDICTS = (
    "audit.json",
    "pairs.parquet",
    "clusters.parquet",
    "verdicts.json",
)
AGAIN = "audit it again: cutcell dataset audit"


def save_audit(
    audit: Audit, folder: Path, first: Sequence[Path] = (), second: Sequence[Path] = ()
) -> None:
    """Write an audit to a folder.

    `audit.json` and `clusters.parquet` list the assets to keep, `pairs.parquet` all pairs, and
    `verdicts.json` the verdicts of a reviewer.

    Parameters
    ----------
    found : Audit
    folder : Path
    first, second : sequence of Path
        Inputs of the audit, for `load_audit`.

    Raises
    ------
    FileError
        They cannot be written.
    MissingLibraryError
        pyarrow or scikit-learn is not installed.
    """
    inputs = [[str(path.resolve()) for path in paths] for paths in (first, second)]
    more = {"inputs": inputs, "threshold": audit.threshold, "least": audit.least}
    write_all({folder / PAIRS: table_bytes(audit.rows()), **_contents(audit, folder, more)})


def save_verdicts(audit: Audit, folder: Path) -> None:
    """Write the verdicts on pairs and the resulting assets to keep to the folder of an audit.

    Raises
    ------
    FileError
        They cannot be written, or there is no audit.
    MissingLibraryError
        pyarrow or scikit-learn is not installed.
    """
    before = _document(folder / AUDIT)
    more = {name: before[name] for name in ("inputs", "threshold", "least")}
    write_all(_contents(audit, folder, more))


def _contents(audit: Audit, folder: Path, more: dict[str, Any]) -> dict[Path, bytes]:
    keep = set(audit.keep)
    labels = [None] * len(audit.names) if audit.labels is None else audit.labels.tolist()
    assets = [
        {"name": name, "cluster": label, "keep": name in keep}
        for name, label in zip(audit.names, labels, strict=True)
    ]
    verdicts = [{"a": a, "b": b, "verdict": verdict} for (a, b), verdict in audit.verdicts.items()]
    return {
        folder / CLUSTERS: table_bytes(assets),
        folder / AUDIT: _json({**audit.to_dict(), **more}),
        folder / VERDICTS: _json(verdicts),
    }


def _json(value: Any) -> bytes:
    return json.dumps(value, indent=1).encode("utf-8", "replace") + b"\n"


def read_verdicts(folder: Path) -> dict[tuple[str, str], str]:
    """Return the verdicts on the pairs of an audit; empty without a file."""
    path = folder / VERDICTS
    if not path.exists():
        return {}
    try:
        verdicts = {(row["a"], row["b"]): row["verdict"] for row in _document(path)}
    except (TypeError, KeyError):
        verdicts = {("", ""): ""}
    if not set(verdicts.values()) <= {DUPLICATE, DIFFERENT}:
        raise FileError(
            f'{path}: must be a list of {{"a": name, "b": name, "verdict": "{DUPLICATE}" or '
            f'"{DIFFERENT}"}}; put it right, or remove it'
        )
    return verdicts


def load_audit(folder: Path) -> Audit:
    """Return a saved audit with its characters.

    Raises
    ------
    FileError
        There is no audit, or its characters have moved.
    MissingLibraryError
        pyarrow is not installed.
    """
    document = _document(folder / AUDIT)
    try:
        first, second = ([Path(path) for path in paths] for paths in document["inputs"])
        counts = document["candidates"], document["failed"]
        figures = document["seconds"], document["threshold"], document["least"]
    except (TypeError, KeyError, ValueError):
        raise FileError(f"{folder / AUDIT}: does not name its inputs; {AGAIN}") from None
    left_out = set(counts[1])
    sources = [source for source in find_sources(first) if source.name not in left_out]
    others = sources
    if second:
        others = [source for source in find_sources(second) if source.name not in left_out]
    names = [source.name for source in sources], [source.name for source in others]
    pairs = list(_pairs(read_table(folder / PAIRS), *names, folder))
    near = [pair for tier, pair in pairs if tier != "posed"]
    posed = [pair for tier, pair in pairs if tier == "posed"]
    verdicts = read_verdicts(folder)
    return Audit(*names, near, posed, *counts, sources, others, *figures, verdicts)


def _pairs(
    rows: Iterable[dict[str, Any]], names: list[str], others: list[str], folder: Path
) -> Iterable[tuple[str, Pair]]:
    place = {name: k for k, name in enumerate(names)}
    other = {name: k for k, name in enumerate(others)}
    figures = [field.name for field in fields(Similarity)]
    for row in rows:
        try:
            ends = place[row["a"]], other[row["b"]]
            alike = Similarity(**{name: row[name] for name in figures})
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
