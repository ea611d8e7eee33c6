"""Choices of the panel Graph."""

from __future__ import annotations

from importlib.util import find_spec
from typing import Any

import param

from ...document.common import MOMENT
from ...document.method import GRAPH, READABLE, choices_of
from ...document.state import Panel

MODULES = {"open3d": "open3d", "embree": "embreex", "fast": "igl"}
"""Libraries that also cast rays or compute winding numbers, and the module of each."""
INSTALLED = [name for name, module in MODULES.items() if find_spec(module)]

CASTERS = {"cutcell": "raster", "Open3D": "open3d", "Embree": "embree"}
WINDINGS = {"cutcell, exact": "exact", "libigl, fast": "fast"}
AXES = {"X": "x", "Y": "y", "Z": "z"}

LAYERS = {
    "body": "body",
    "mesh_edges": "mesh edges",
    "interior_edges": "interior edges",
    "surface_edges": "surface edges",
}
"""The layers that can be switched, and the actor that each shows."""

PANEL = Panel(
    "Graph",
    '<path d="M12 3l8 4.5v9L12 21l-8-4.5v-9z"/><path d="M4 7.5l8 4.5 8-4.5M12 12v9"/>',
    cuts=True,
    works_without_skeleton=True,
)


class Choices(choices_of(GRAPH)):  # type: ignore[misc]
    """How the graph is built, and what of it is seen."""

    graph_resolution = param.Integer(
        READABLE, bounds=(0, 512), doc="Of the graph that is shown; 0 for the one of the weights."
    )
    easy_graph: Any = param.Parameter(None, doc="A graph to show, easier to read; or None.")

    body = param.Boolean(True, label="Surface")
    mesh_edges = param.Boolean(True, label="Mesh edges")
    interior_edges = param.Boolean(True, label="Interior edges")
    surface_edges = param.Boolean(True, label="Surface edges")
    nodes = param.Boolean(True, label="Nodes")
    edge_colors: param.Selector[str] = param.Selector(
        default="kind",
        objects={"Kind": "kind", "Depth": "depth", "Distance": "distance", "Part": "component"},
    )
    node = param.Integer(
        None, allow_None=True, doc="The node that is looked at, or None.", precedence=MOMENT
    )

    cut_keeps: param.Selector[str] = param.Selector(
        default="face",
        objects={"Half": "half", "Face only": "face", "Slab": "slab"},
        doc="Behind a cut: all, of the interior the first cells only, or the part between two "
        "planes.",
    )
    slab = param.Number(
        0.1, bounds=(0.01, 0.6), step=0.01, label="Thickness of the slab",
        doc="Between the planes, of the longest side.",
    )  # fmt: skip

    slicing = param.Boolean(False, label="One slice and its rays")
    slice_axis: param.Selector[str] = param.Selector(default="z", objects=AXES, doc="Its normal.")
    slice_rays: param.Selector[str] = param.Selector(
        default="x", objects=AXES, doc="Which way they run."
    )
    slice_caster: param.Selector[str] = param.Selector(
        default="raster",
        objects={t: name for t, name in CASTERS.items() if name in ("raster", *INSTALLED)},
        doc="What casts the rays.",
    )
    slice_winding: param.Selector[str] = param.Selector(
        default="exact",
        objects={t: name for t, name in WINDINGS.items() if name in ("exact", *INSTALLED)},
        doc="What computes winding numbers.",
    )
    slice_position = param.Number(
        0.5, bounds=(0, 1), step=0.005, label="Position", doc="Across the box of the body."
    )

    @property
    def graph_inputs(self) -> tuple[Any, ...] | None:
        """Method of the shown graph; None where it is the one of the weights."""
        state: Any = self
        if self.graph_resolution in (0, self.resolution) or state.rig is None:
            return None
        method = self.connectivity, self.winding_threshold, self.orient
        return state.rig.mesh, self.graph_resolution, *method

    @property
    def shown_graph(self) -> Any:
        """The graph that the panel shows; None until it is built."""
        state: Any = self
        return state.graph if self.graph_inputs is None else self.easy_graph
