"""PyVista's meshes as the arrays of an actor."""

from typing import Any

import numpy as np
import pyvista as pv
from numpy.typing import NDArray


def arrays_of(mesh: pv.DataSet, scalars: str | None = None) -> dict[str, Any]:
    """Return fields of an `Actor` that shows a mesh; see `Actor.from_polydata`."""
    data: Any = mesh if isinstance(mesh, pv.PolyData) else mesh.extract_surface(algorithm=None)
    kind, cells = _cells(data)
    values: dict[str, Any] = {}
    if scalars is not None:
        array = np.asarray(data[scalars])
        if len(array) != data.n_points:
            data = data.cell_data_to_point_data()
            array = np.asarray(data[scalars])
        values = _colouring(array)
    normals = data.point_data.active_normals if kind == "surface" else None
    return {"kind": kind, "points": data.points, "cells": cells, "normals": normals, **values}


def _cells(data: pv.PolyData) -> tuple[str, NDArray[np.int32]]:
    """Return the kind of a mesh, and its triangles (m, 3), segments (m, 2) or points (m, 1)."""
    if len(data.faces):
        return "surface", data.triangulate().regular_faces.astype(np.int32)
    if data.n_lines:
        ends, at, lines = [], 0, np.asarray(data.lines)
        while at < len(lines):
            chain = lines[at + 1 : at + 1 + lines[at]]
            ends.append(np.stack([chain[:-1], chain[1:]], axis=1))
            at += 1 + lines[at]
        return "lines", np.concatenate(ends).astype(np.int32)
    return "points", np.arange(data.n_points, dtype=np.int32)[:, None]


def _colouring(array: NDArray[Any]) -> dict[str, Any]:
    """Return the colours or the scalars of an actor from a mesh's array, one row a point."""
    if array.ndim == 2 and array.shape[1] in (3, 4) and array.dtype == np.uint8:
        return {"colors": array[:, :3]}
    values = np.asarray(array, np.float32)
    if values.ndim == 2:
        values = np.linalg.norm(values, axis=1)
    limits = (float(np.nanmin(values)), float(np.nanmax(values))) if len(values) else (0.0, 1.0)
    return {"scalars": values, "limits": limits}
