"""PyVista's plotters as descriptions, and legends of descriptions in a plotter."""

from typing import Any

import numpy as np
import pyvista as pv
from numpy.typing import NDArray

from .description import Actor, Description, Legend
from .palette import Theme, colormap

SHADES = "cutcell shades"
"""The array of a mesh in which its colours are stored while it becomes an actor."""


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
    return Actor.from_polydata(mesh, SHADES if SHADES in mesh.array_names else None, **style)


def lookup_table(colors: NDArray[np.uint8]) -> pv.LookupTable:
    """Return opaque colours (n, 3) as a table of PyVista."""
    return pv.LookupTable(values=np.hstack([colors, np.full((len(colors), 1), 255, np.uint8)]))
