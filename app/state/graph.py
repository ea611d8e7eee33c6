"""What a person can choose on the panel Graph."""

from typing import Any

import param

from cutcell.geodesics import LEAVES

from .method import default

LAYERS = {
    "body": "body",
    "mesh_edges": "mesh edges",
    "interior_edges": "interior edges",
    "surface_edges": "surface edges",
}
"""The layers that can be switched, and the actor that each shows."""


class GraphChoices(param.Parameterized):
    """How the graph is built, and what of it is seen."""

    resolution: Any = param.Integer(
        default("resolution"), doc="Lattice cells along the longest side."
    )
    connectivity: Any = param.Selector(default=default("connectivity"), objects=[6, 26, "any"])
    winding_threshold: Any = param.Number(default("winding_threshold"), bounds=(0, 1))
    orient: Any = param.Boolean(default("orient"), label="Flip inverted faces")
    leaf: Any = param.Selector(default=default("leaf"), objects=list(LEAVES))

    body: Any = param.Boolean(True, label="Surface")
    mesh_edges: Any = param.Boolean(False, label="Mesh edges")
    interior_edges: Any = param.Boolean(True, label="Interior edges")
    surface_edges: Any = param.Boolean(False, label="Surface edges")
    nodes: Any = param.Boolean(False, label="Nodes")
    edge_colors: Any = param.Selector(
        default="kind", objects=["kind", "depth", "distance", "component"]
    )
    node: Any = param.Integer(None, allow_None=True, doc="The node that is looked at, or None.")

    cut_keeps: Any = param.Selector(
        default="face",
        objects=["half", "face", "slab"],
        doc="Behind a cut: all, of the interior the first cells only, or what lies between two "
        "planes.",
    )
    slab: Any = param.Number(
        0.1, bounds=(0.01, 0.6), doc="Between the planes, of the longest side."
    )

    slicing: Any = param.Boolean(False, label="One slice and its rays")
    slice_axis: Any = param.Selector(default="z", objects=["x", "y", "z"], doc="Its normal.")
    slice_rays: Any = param.Selector(
        default="x", objects=["x", "y", "z"], doc="Which way they run."
    )
    slice_position: Any = param.Number(0.5, bounds=(0, 1), doc="Across the box of the body.")
