"""Weights and distances as plain numbers, for spreadsheets and scripts."""

from __future__ import annotations

import csv
from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..errors import FileError, ParameterError
from ..rig import Rig

DIGITS = 7
"""Significant digits of a CSV's numbers: what 32 bits hold."""


def save_numbers(path: str | Path, rig: Rig, **tables: ArrayLike) -> None:
    """Save numbers of every vertex and joint.

    Parameters
    ----------
    path : str or Path
        Ends in ".csv": one table, a row a vertex and a column a joint, with a first column
        of vertex numbers and a first row of joint names. Or in ".npz": all tables, and
        beside them "joint_names" (j,), "parents" (j,) and "vertex_indices" (n,).
    rig : Rig
        What the numbers belong to.
    **tables : array_like, shape (n, j)
        By name, such as `weights=binding.weights`; a CSV holds one of them.

    Raises
    ------
    FileError
        Another ending, or a folder that is not there.
    ParameterError
        No table, several for a CSV, or one of another shape.
    """
    path = Path(path)
    shape = (len(rig.mesh.vertices), len(rig.skeleton.joints))
    arrays = {name: np.asarray(table, np.float64) for name, table in tables.items()}
    for name, array in arrays.items():
        if array.shape != shape:
            raise ParameterError(
                f"{name} has the shape {array.shape}, but the rig has {shape[0]} vertices and "
                f"{shape[1]} joints"
            )
    if not path.absolute().parent.is_dir():
        raise FileError(f"{path.name}: there is no folder {path.parent} to save it in")
    kind = path.suffix.lower()
    if kind == ".npz":
        _save_npz(path, rig, arrays)
    elif kind == ".csv":
        if len(arrays) != 1:
            raise ParameterError(f"a CSV holds one table, not {len(arrays)}; save an NPZ for all")
        _save_csv(path, rig, next(iter(arrays.values())))
    else:
        raise FileError(f'{path.name}: numbers are saved as .csv or .npz, not as "{kind}"')


def _save_npz(path: Path, rig: Rig, arrays: dict[str, NDArray[np.float64]]) -> None:
    if not arrays:
        raise ParameterError("there are no numbers to save")
    np.savez_compressed(
        path,
        joint_names=np.array(rig.skeleton.names),
        parents=rig.skeleton.parents,
        vertex_indices=np.arange(len(rig.mesh.vertices)),
        **arrays,  # type: ignore[arg-type]
    )


def _save_csv(path: Path, rig: Rig, table: NDArray[np.float64]) -> None:
    with path.open("w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file)
        writer.writerow(["vertex", *rig.skeleton.names])
        for vertex, row in enumerate(table.tolist()):
            writer.writerow([vertex, *(f"{value:.{DIGITS}g}" for value in row)])
