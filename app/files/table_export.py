"""Weights and distances as plain numbers, for spreadsheets and scripts."""

import csv
from io import BytesIO, StringIO
from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike, NDArray

from cutcell.errors import FileError, ParameterError
from cutcell.rig import Rig
from cutcell.runtime.display import spreadsheet_cell
from cutcell.runtime.writing import check_place, write_all

DIGITS = 7
"""Significant digits of a CSV's numbers: what 32 bits hold."""


def save_numbers(path: str | Path, rig: Rig, **tables: ArrayLike) -> None:
    """Save numbers of every vertex and joint.

    Shapes: **tables (n, j).
    """
    path = Path(path)
    shape = (len(rig.mesh.vertices), len(rig.skeleton.joints))
    arrays = {name: np.asarray(table) for name, table in tables.items()}
    for name, array in arrays.items():
        if array.dtype.kind not in "biuf":
            raise ParameterError(f"{name} must be real numbers, not {array.dtype}")
        if array.shape != shape:
            raise ParameterError(
                f"{name} has the shape {array.shape}, but the rig has {shape[0]} vertices and "
                f"{shape[1]} joints"
            )
    check_place(path)
    kind = path.suffix.lower()
    if kind == ".npz":
        if not arrays:
            raise ParameterError("there are no numbers to save")
        pack = _packed_npz
    elif kind == ".csv":
        if len(arrays) != 1:
            raise ParameterError(f"a CSV holds one table, not {len(arrays)}; save an NPZ for all")
        pack = _packed_csv
    else:
        raise FileError(f'{path.name}: numbers are saved as .csv or .npz, not as "{kind}"')
    write_all({path: pack(rig, arrays)})


def _packed_npz(rig: Rig, arrays: dict[str, NDArray]) -> bytes:
    packed = BytesIO()
    np.savez_compressed(
        packed,
        joint_names=np.array(rig.skeleton.names),
        parents=rig.skeleton.parents,
        vertex_indices=np.arange(len(rig.mesh.vertices)),
        **{name: array.astype(np.float64) for name, array in arrays.items()},  # type: ignore[arg-type]
    )
    return packed.getvalue()


def _packed_csv(rig: Rig, arrays: dict[str, NDArray]) -> bytes:
    (table,) = arrays.values()
    packed = StringIO(newline="")
    writer = csv.writer(packed)
    writer.writerow(["vertex", *map(spreadsheet_cell, rig.skeleton.names)])
    for vertex, row in enumerate(table.astype(np.float64).tolist()):
        writer.writerow([vertex, *(f"{value:.{DIGITS}g}" for value in row)])
    return packed.getvalue().encode()
