"""PyVista's meshes and plotters as descriptions, and legends of descriptions in a plotter."""

from typing import Any, Literal

import numpy as np
import pyvista as pv
from numpy.typing import NDArray

from .description import Actor, Description, Legend
from .palette import Theme, colormap

SHADES = "cutcell shades"
"""The array of a mesh in which its colours are stored while it becomes an actor."""


def actor_of(mesh: pv.DataSet, scalars: str | None = None, **settings: Any) -> Actor:
    """Return a mesh as an actor; see `Actor.from_polydata`."""
    data: Any = mesh if isinstance(mesh, pv.PolyData) else mesh.extract_surface(algorithm=None)
    kind, cells = _cells(data)
    values: dict[str, Any] = {}
    if scalars is not None:
        array = np.asarray(data[scalars])
        if len(array) != data.n_points:
            data = data.cell_data_to_point_data()
            array = np.asarray(data[scalars])
        values = _colouring(array)
    points = np.asarray(data.points, np.float32)
    normals = data.point_data.active_normals if kind == "surface" else None
    if normals is not None:
        normals = np.asarray(normals, np.float32)
    return Actor(kind, points, cells, **{"normals": normals, **values, **settings})


def describe(plotter: pv.Plotter) -> Description:
    """Return the scene of a plotter; see `cutcell_viewers.describe`."""
    actors = {}
    for name, drawn in plotter.renderer.actors.items():
        mapper: Any = getattr(drawn, "mapper", None)
        if isinstance(drawn, pv.Actor) and mapper is not None and mapper.dataset is not None:
            actors[name] = _described(drawn, mapper)
    return Description(actors)


def add_legend(plotter: Any, legend: Legend, theme: Theme) -> None:
    """Write a description's legend into a plotter."""
    if legend.colormap:
        table = lookup_table(colormap(legend.colormap))
        table.scalar_range = (0, 1)
        table.annotations = {0.0: legend.low, 1.0: legend.high}
        plotter.add_scalar_bar(
            legend.title,
            lookup_table=table,
            n_labels=0,
            color=theme.ink,
            position_x=0.03,
            position_y=0.04,
            width=0.25,
            height=0.09,
        )
    if legend.swatches:
        labels = [[text, color] for color, text in legend.swatches]
        if not legend.colormap:
            labels.insert(0, [legend.title, theme.bottom])
        box: Any = plotter.add_legend(
            labels, bcolor=None, face="rectangle", loc="lower left", size=(0.3, 0.05 * len(labels))
        )
        box.GetEntryTextProperty().SetColor(*theme.ink)


def _described(drawn: pv.Actor, mapper: Any) -> Actor:
    look = drawn.prop
    style: dict[str, Any] = {
        "color": tuple(look.color.float_rgb),
        "opacity": float(look.opacity),
        "visible": bool(drawn.visibility),
        "width": float(look.point_size if look.style == "Points" else look.line_width),
        "clipped": False,
    }
    mesh = mapper.dataset.copy()
    name = mapper.array_name if mapper.scalar_visibility else ""
    if name in mesh.array_names:
        values = np.ascontiguousarray(mesh[name])
        if values.ndim == 1:  # else these are colours
            mapped = mapper.lookup_table.MapScalars(pv.convert_array(values), 0, -1)
            values = pv.convert_array(mapped)
        of = mesh.point_data if len(values) == mesh.n_points else mesh.cell_data
        of[SHADES] = values
    mesh.transform(pv.array_from_vtkmatrix(drawn.GetMatrix()), inplace=True)
    return actor_of(mesh, SHADES if SHADES in mesh.array_names else None, **style)


def _cells(
    data: pv.PolyData,
) -> tuple[Literal["surface", "lines", "points"], NDArray[np.int32]]:
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


def lookup_table(colors: NDArray[np.uint8]) -> pv.LookupTable:
    """Return opaque colours (n, 3) as a table of PyVista."""
    return pv.LookupTable(values=np.hstack([colors, np.full((len(colors), 1), 255, np.uint8)]))
