"""Choices of the panel Graph."""

from __future__ import annotations

from importlib.util import find_spec
from typing import Any

import param

from cutcell.geodesics import LEAVES

from .method import default

READABLE = 40
"""Lattice cells along the longest side of a graph that is easy to read on a screen."""

MODULES = {"open3d": "open3d", "embree": "embreex", "fast": "igl"}
"""Libraries that also cast rays or compute winding numbers, and the module of each."""
INSTALLED = [name for name, module in MODULES.items() if find_spec(module)]

LAYERS = {
    "body": "body",
    "mesh_edges": "mesh edges",
    "interior_edges": "interior edges",
    "surface_edges": "surface edges",
}
"""The layers that can be switched, and the actor that each shows."""


class GraphChoices(param.Parameterized):
    """How the graph is built, and what of it is seen."""

    graph_resolution = param.Integer(
        READABLE, bounds=(0, 512), doc="Of the graph that is shown; 0 for the one of the weights."
    )
    easy_graph: Any = param.Parameter(None, doc="(what it was built from, graph) to show.")
    resolution = param.Integer(default("resolution"), doc="Lattice cells along the longest side.")
    connectivity: param.Selector[int | str] = param.Selector(
        default=default("connectivity"), objects=[6, 26, "any"]
    )
    winding_threshold = param.Number(
        default("winding_threshold"),
        bounds=(0, 1),
        inclusive_bounds=(False, False),
        softbounds=(0.01, 0.99),
    )
    orient = param.Boolean(default("orient"), label="Flip inverted faces")
    leaf: param.Selector[str] = param.Selector(default=default("leaf"), objects=list(LEAVES))

    body = param.Boolean(True, label="Surface")
    mesh_edges = param.Boolean(True, label="Mesh edges")
    interior_edges = param.Boolean(True, label="Interior edges")
    surface_edges = param.Boolean(True, label="Surface edges")
    nodes = param.Boolean(True, label="Nodes")
    edge_colors: param.Selector[str] = param.Selector(
        default="kind", objects=["kind", "depth", "distance", "component"]
    )
    node = param.Integer(None, allow_None=True, doc="The node that is looked at, or None.")

    cut_keeps: param.Selector[str] = param.Selector(
        default="face",
        objects=["half", "face", "slab"],
        doc="Behind a cut: all, of the interior the first cells only, or the part between two "
        "planes.",
    )
    slab = param.Number(0.1, bounds=(0.01, 0.6), doc="Between the planes, of the longest side.")

    slicing = param.Boolean(False, label="One slice and its rays")
    slice_axis: param.Selector[str] = param.Selector(
        default="z", objects=["x", "y", "z"], doc="Its normal."
    )
    slice_rays: param.Selector[str] = param.Selector(
        default="x", objects=["x", "y", "z"], doc="Which way they run."
    )
    slice_caster: param.Selector[str] = param.Selector(
        default="raster",
        objects=["raster", *(name for name in INSTALLED if name != "fast")],
        doc="What casts the rays.",
    )
    slice_winding: param.Selector[str] = param.Selector(
        default="exact",
        objects=["exact", *(name for name in INSTALLED if name == "fast")],
        doc="What computes winding numbers.",
    )
    slice_position = param.Number(0.5, bounds=(0, 1), doc="Across the box of the body.")

    @property
    def graph_inputs(self) -> tuple[Any, ...] | None:
        """Method of the shown graph; None where it is the one of the weights."""
        state: Any = self
        if self.graph_resolution in (0, self.resolution) or state.rig is None:
            return None
        return (
            state.rig.mesh,
            self.graph_resolution,
            self.connectivity,
            self.winding_threshold,
            self.orient,
        )

    @property
    def shown_graph(self) -> Any:
        """The graph that the panel shows; None until it is built."""
        state: Any = self
        inputs = self.graph_inputs
        if inputs is None:
            return state.graph
        built, graph = self.easy_graph or ((), None)
        return graph if built == inputs else None
