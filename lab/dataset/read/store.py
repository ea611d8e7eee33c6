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
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from cutcell import __version__
from cutcell.checks import check_choice
from cutcell.errors import FileError, MissingLibraryError
from cutcell.io.files import one_line
from cutcell.method import PAPER, Method
from cutcell.runtime.sources import PACKAGE, source_digest
from cutcell.runtime.writing import reason, sweep, write_all

STORE = "store.json"
"""The file that marks a folder as a store of `cutcell dataset bind`."""
MANIFEST = "manifest.parquet"
FORMAT = 1
"""Format of the files in the store; part of their names."""
Precision = Literal["float32", "float16"]
PRECISIONS: tuple[Precision, ...] = ("float32", "float16")
SPARSE = 0.5
"""A table is stored as its entries if fewer than this share of them is finite and not zero."""

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
    arrow, parquet = _arrow()
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
    arrow, parquet = _arrow()
    try:
        return parquet.read_table(path).to_pylist()
    except (OSError, arrow.ArrowException) as error:
        raise FileError(f"{path.name}: cannot be read ({reason(error)})") from None


def _arrow() -> tuple[Any, Any]:
    try:
        import pyarrow
        import pyarrow.parquet
    except ImportError:
        raise MissingLibraryError(
            "tables are read and written by pyarrow, which is not installed; try: pip install "
            "'cutcell[dataset]'"
        ) from None
    return pyarrow, pyarrow.parquet


@dataclass(frozen=True, eq=False)
class Entry:
    """One asset of the store.

    Parameters
    ----------
    vertices : array, shape (n, 3), float32
    faces : array, shape (m, 3), int32
    joints : array, shape (j, 3), float32
    parents : array, shape (j,), int32
    names : tuple of str
    scale : float
        Longest side of the mesh; times it, distances are in the units of the vertices.
    weights : array, shape (n, j), float32
        Computed weights.
    artist : array, shape (n, j), float32, or None
        Weights of the file.
    distances : array, shape (n, j), float32
        From each joint's bones, in longest sides; infinite where not needed or not connected.
    bone_joints : array, shape (b, 2), int32
        The joints at both ends of each bone, in RigNet's order; twice the same for the point of a
        joint without children. (0, 2) without distances of bones.
    bone_distances : array, shape (n, b), float32
        From each of these bones.
    """

    vertices: NDArray[np.float32]
    faces: NDArray[np.int32]
    joints: NDArray[np.float32]
    parents: NDArray[np.int32]
    names: tuple[str, ...]
    scale: float
    weights: NDArray[np.float32]
    artist: NDArray[np.float32] | None
    distances: NDArray[np.float32]
    bone_joints: NDArray[np.int32]
    bone_distances: NDArray[np.float32]


def entry_bytes(entry: Entry, precision: Precision) -> bytes:
    """Return an entry as an npz file, the same bytes for the same entry."""
    arrays: dict[str, NDArray] = {
        "vertices": entry.vertices,
        "faces": entry.faces,
        "joints": entry.joints,
        "parents": entry.parents,
        "names": np.array(entry.names, np.str_),
        "scale": np.array(entry.scale),
        "bone_joints": entry.bone_joints,
    }
    tables = {"weights": (entry.weights, 0.0), "distances": (entry.distances, np.inf),
              "bone_distances": (entry.bone_distances, np.inf)}  # fmt: skip
    if entry.artist is not None:
        tables["artist"] = entry.artist, 0.0
    for name, (table, empty) in tables.items():
        arrays |= _packed(name, table, empty, precision)
    packed = io.BytesIO()
    np.savez_compressed(packed, **arrays)  # type: ignore[arg-type]
    return packed.getvalue()


def read_entry(path: Path) -> Entry:
    """Read an asset's file.

    Raises
    ------
    FileError
        It is not there, or damaged.
    """
    try:
        with np.load(path, allow_pickle=False) as file:
            arrays = {name: file[name] for name in file.files}
        shape = len(arrays["vertices"]), len(arrays["joints"])
        return Entry(
            arrays["vertices"],
            arrays["faces"],
            arrays["joints"],
            arrays["parents"],
            tuple(arrays["names"].tolist()),
            float(arrays["scale"]),
            _unpacked("weights", arrays, 0.0),
            _unpacked("artist", arrays, 0.0) if "artist_shape" in arrays else None,
            _unpacked("distances", arrays, np.inf).reshape(shape),
            arrays["bone_joints"],
            _unpacked("bone_distances", arrays, np.inf),
        )
    except (FileNotFoundError, PermissionError, IsADirectoryError) as error:
        raise FileError(f"{path.name}: cannot be read ({reason(error)})") from None
    except Exception as error:  # zipfile and its decoders raise whatever their parsing runs into
        raise FileError(
            f"{path.name}: is damaged, or no file of a store ({one_line(error)}); remove it and "
            "run `cutcell dataset bind` again"
        ) from None


def _packed(name: str, table: NDArray, empty: float, precision: str) -> dict[str, NDArray]:
    """Store a table whole, or as its entries if few differ from `empty`."""
    shape = {f"{name}_shape": np.array(table.shape, np.int64)}
    is_entry = table != empty
    if not table.size or is_entry.mean() >= SPARSE:
        return {**shape, name: table.astype(precision)}
    rows, columns = np.nonzero(is_entry)
    return {
        **shape,
        f"{name}_row": rows.astype(np.int32),
        f"{name}_col": columns.astype(np.int32),
        f"{name}_value": table[rows, columns].astype(precision),
    }


def _unpacked(name: str, arrays: Mapping[str, NDArray], empty: float) -> NDArray[np.float32]:
    if name in arrays:
        return arrays[name].astype(np.float32)
    table = np.full(tuple(arrays[f"{name}_shape"]), empty, np.float32)
    table[arrays[f"{name}_row"], arrays[f"{name}_col"]] = arrays[f"{name}_value"]
    return table
