"""Weights and distances as plain numbers, for spreadsheets and scripts."""

import csv
import json
from collections.abc import Mapping
from dataclasses import asdict
from io import BytesIO, StringIO
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from cutcell.binding import Binding
from cutcell.editing.stored import ABOUT
from cutcell.errors import FileError, ParameterError
from cutcell.graph import CutCellGraph
from cutcell.rig import Rig
from cutcell.runtime.display import printable
from cutcell.runtime.writing import check_place, write_all

FORMULA = tuple("=+-@\t\r＝＋－＠")
"""Prefixes that start a formula in a spreadsheet."""
DIGITS = 7
"""Significant digits of a CSV's numbers, as of 32 bits."""


def settings_of(result: Binding | CutCellGraph) -> dict[str, Any]:
    """Return the settings that a result was computed with, the program's version and the unit."""
    if isinstance(result, Binding):
        return {**ABOUT, **asdict(result.method)}
    options = {
        "resolution": result.lattice.resolution,
        "connectivity": result.connectivity,
        "winding_threshold": result.winding_threshold,
    }
    return {**ABOUT, **options}


def save_numbers(
    path: str | Path, rig: Rig, *, settings: Mapping[str, Any] | None = None, **tables: ArrayLike
) -> None:
    """Save numbers of every vertex and joint.

    Parameters
    ----------
    path : path
        Ends in ".csv", for one table, or in ".npz".
    rig : Rig
    settings : mapping, optional
        See `settings_of`: lines that begin with "#" before a CSV's header, or JSON as the array
        "settings" of an NPZ.
    **tables : array_like, shape (n, j)
        Lengths are in the file's units.
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
    write_all({path: pack(rig, arrays, settings or {})})


def _packed_npz(rig: Rig, arrays: dict[str, NDArray], settings: Mapping[str, Any]) -> bytes:
    packed = BytesIO()
    about = {"settings": np.array(json.dumps(settings))} if settings else {}
    np.savez_compressed(
        packed,
        joint_names=np.array(rig.skeleton.names),
        parents=rig.skeleton.parents,
        vertex_indices=np.arange(len(rig.mesh.vertices)),
        **about,  # type: ignore[arg-type]
        **{name: array.astype(np.float64) for name, array in arrays.items()},  # type: ignore[arg-type]
    )
    return packed.getvalue()


def _packed_csv(rig: Rig, arrays: dict[str, NDArray], settings: Mapping[str, Any]) -> bytes:
    ((what, table),) = arrays.items()
    packed = StringIO(newline="")
    writer = csv.writer(packed)
    lines = {"table": what, **settings} if settings else {}
    packed.writelines(f"# {name}: {value}\r\n" for name, value in lines.items())
    writer.writerow(["vertex", *map(spreadsheet_cell, rig.skeleton.names)])
    for vertex, row in enumerate(table.astype(np.float64).tolist()):
        writer.writerow([vertex, *(f"{value:.{DIGITS}g}" for value in row)])
    return packed.getvalue().encode()


def spreadsheet_cell(name: str) -> str:
    """Return a name as a cell; formulas get an apostrophe (OWASP, "CSV Injection")."""
    is_formula = name.lstrip().startswith(FORMULA) or name.startswith(FORMULA)
    return f"'{printable(name)}" if is_formula else printable(name)
