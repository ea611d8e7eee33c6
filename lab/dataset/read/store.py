"""The store: one file for each asset and its parameters, and a manifest of all.

    STORE/store.json                 marks the folder, with its parameters
    STORE/ab/abcdef....npz           distances, weights, mesh and skeleton; the same bytes each time
    STORE/ab/abcdef....json          sizes, metrics, warnings or the error, seconds
    STORE/manifest.parquet           a row for each source

Files are named by a hash of the asset's bytes, of the parameters and of the code that computes.
The manifest keeps the rows of earlier calls with the same parameters and code. Writing is atomic,
so a store is valid whenever its writer is stopped.
"""

from __future__ import annotations

import hashlib
import io
import json
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from cutcell import __version__
from cutcell.checks import check_choice
from cutcell.errors import FileError, MissingLibraryError
from cutcell.method import PAPER, Method
from cutcell.runtime.sources import PACKAGE, source_digest
from cutcell.runtime.writing import reason, sweep, write_all

from .entry import PRECISIONS, Entry, Precision, read_entry

STORE = "store.json"
"""The file that marks a folder as a store of `cutcell dataset bind`."""
MANIFEST = "manifest.parquet"
FORMAT = 1
"""Format of the files in the store; part of their names."""
SIZES = ("vertices", "faces", "joints", "bones", "nodes", "edges")
METRICS = ("l1", "precision", "recall", "deformation", "fallback", "influences", "stretch")
STAGES = ("load", "graph", "distances", "weights", "bones", "metrics")


@dataclass(frozen=True)
class Parameters:
    """Parameters of a store; their hash and that of the asset's bytes name the file.

    Parameters
    ----------
    method : Method
        How weights are computed.
    precision : {"float32", "float16"}
        Of stored distances and weights.
    bones : bool
        Whether the distances of every single bone are computed, too: RigNet needs them.
    """

    method: Method = PAPER
    precision: Precision = "float32"
    bones: bool = True

    def __post_init__(self) -> None:
        check_choice("precision", self.precision, PRECISIONS)

    def to_dict(self) -> dict[str, Any]:
        """Return all of it as plain data, with a hash of the code that computes."""
        code = source_digest(PACKAGE, Path(__file__).resolve().parents[1])
        return {**asdict(self), "version": __version__, "format": FORMAT, "code": code}

    def digest(self) -> str:
        """Return a hash of all of it, 16 hexadecimal digits."""
        text = json.dumps(self.to_dict(), sort_keys=True)
        return hashlib.blake2b(text.encode(), digest_size=8).hexdigest()


@dataclass(frozen=True)
class Outcome:
    """Result of binding one asset."""

    key: str
    """Name of its files."""
    record: Mapping[str, Any]
    """`sizes`, `metrics`, `warnings`, `error` (empty if there is none), `seconds`, `version`."""
    data: bytes | None = None
    """The npz file; None after an error, or if the store has it."""

    @property
    def error(self) -> str:
        """Why there is no file; empty where there is one."""
        return str(self.record.get("error", ""))


class Store:
    """A folder of bound assets.

    Parameters
    ----------
    folder : Path
    """

    def __init__(self, folder: Path) -> None:
        self.folder = folder

    def begin(self, parameters: Parameters) -> None:
        """Prepare the folder for writing, and remove files of killed writers.

        Raises
        ------
        FileError
            The folder contains other files, or cannot be written to.
        """
        if self.folder.is_dir() and not self.exists() and any(self.folder.iterdir()):
            raise FileError(f"{self.folder}: holds other files; name a new folder, or a store")
        for folder in [self.folder, *self.folder.glob("[0-9a-f][0-9a-f]")]:
            sweep(folder)
        text = json.dumps({"cutcell": "dataset", **parameters.to_dict()}, indent=2, sort_keys=True)
        write_all({self.folder / STORE: text.encode() + b"\n"})

    def exists(self) -> bool:
        """Return whether the folder is a store."""
        return (self.folder / STORE).is_file()

    def path(self, key: str, ending: str = ".npz") -> Path:
        """Return where a file of an asset is."""
        return self.folder / key[:2] / f"{key}{ending}"

    def outcome(self, key: str) -> Outcome | None:
        """Return the outcome of an asset, None if it was not bound yet or its file is cut short."""
        try:
            record = json.loads(self.path(key, ".json").read_bytes())
        except (OSError, ValueError):
            return None
        if not isinstance(record, dict):
            return None
        file = self.path(key)
        if not record.get("error") and not (
            file.is_file() and file.stat().st_size == record.get("bytes")
        ):
            return None
        return Outcome(key, record)

    def write(self, outcome: Outcome) -> None:
        """Write the files of an asset, both or none; the npz comes last."""
        text = json.dumps(outcome.record, sort_keys=True).encode() + b"\n"
        files = {self.path(outcome.key, ".json"): text}
        if outcome.data is not None:
            files[self.path(outcome.key)] = outcome.data
        write_all(files)

    def write_manifest(self, rows: Sequence[Mapping[str, Any]]) -> Path:
        """Write the manifest; see `manifest_row`."""
        path = self.path_of_manifest
        write_all({path: table_bytes(rows)})
        return path

    @property
    def path_of_manifest(self) -> Path:
        """Where the manifest is, once it is written."""
        return self.folder / MANIFEST

    def manifest(self) -> list[dict[str, Any]]:
        """Return the rows of the manifest.

        Raises
        ------
        FileError
            There is none, or it cannot be read.
        """
        path = self.path_of_manifest
        if not path.is_file():
            raise FileError(f"{self.folder}: is no store; make one: cutcell dataset bind IN OUT")
        return read_table(path)

    def entries(self) -> Iterator[tuple[str, Entry]]:
        """Yield name and content of every asset that was bound."""
        for row in self.manifest():
            if not row["error"]:
                yield row["name"], read_entry(self.folder / row["path"])


def manifest_row(name: str, source: str, content: str, outcome: Outcome) -> dict[str, Any]:
    """Return the row of one source in the manifest."""
    record = outcome.record
    sizes, metrics = record.get("sizes", {}), record.get("metrics", {})
    seconds = record.get("seconds", {})
    path = f"{outcome.key[:2]}/{outcome.key}.npz"
    return {
        "name": name,
        "source": source,
        "path": "" if outcome.error else path,
        "key": outcome.key,
        "content": content,
        **{size: sizes.get(size) for size in SIZES},
        "bytes": record.get("bytes"),
        **{metric: metrics.get(metric) for metric in METRICS},
        **{f"seconds_{stage}": seconds.get(stage) for stage in STAGES},
        "memory": record.get("memory"),
        "warnings": list(record.get("warnings", [])),
        "error": outcome.error,
        "version": record.get("version", __version__),
    }


def table_bytes(rows: Sequence[Mapping[str, Any]]) -> bytes:
    """Return rows as a Parquet file."""
    arrow, parquet = import_arrow()
    columns = {name: [row[name] for row in rows] for name in (rows[0] if rows else ())}
    whole = {*SIZES, "bytes", "memory"}
    arrays = {}
    for name, values in columns.items():
        kind = None
        if name == "warnings":
            kind = arrow.list_(arrow.string())
        elif all(value is None for value in values):
            kind = arrow.int64() if name in whole else arrow.float64()
        arrays[name] = arrow.array(values, kind)
    packed = io.BytesIO()
    parquet.write_table(arrow.table(arrays), packed, compression="zstd")
    return packed.getvalue()


def read_table(path: Path) -> list[dict[str, Any]]:
    """Return the rows of a Parquet file."""
    arrow, parquet = import_arrow()
    try:
        return parquet.read_table(path).to_pylist()
    except (OSError, arrow.ArrowException) as error:
        raise FileError(f"{path.name}: cannot be read ({reason(error)})") from None


def import_arrow() -> tuple[Any, Any]:
    """Import pyarrow and its module for Parquet."""
    try:
        import pyarrow
        import pyarrow.parquet
    except ImportError:
        raise MissingLibraryError(
            "tables are read and written by pyarrow, which is not installed; try: pip install "
            "'cutcell[dataset]'"
        ) from None
    return pyarrow, pyarrow.parquet
