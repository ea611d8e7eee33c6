"""The file of one asset in the store: its mesh, skeleton, weights and distances."""

from __future__ import annotations

import io
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from cutcell.errors import FileError
from cutcell.io.files import one_line
from cutcell.runtime.writing import reason

Precision = Literal["float32", "float16"]
PRECISIONS: tuple[Precision, ...] = ("float32", "float16")
SPARSE = 0.5
"""A table is stored as its entries if fewer than this share of them is finite and not zero."""


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
