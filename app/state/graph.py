"""What a person can choose on the panel Graph."""

from __future__ import annotations

from typing import Any

import param

LAYERS = {
    "body": "body",
    "mesh_edges": "mesh edges",
    "interior_edges": "interior edges",
    "surface_edges": "surface edges",
}
"""The layers that can be switched, and the actor that each shows."""


class GraphChoices(param.Parameterized):
    """How fine the graph is, and what of it is seen."""

    resolution: Any = param.Integer(64, doc="Lattice cells along the longest side.")

    body: Any = param.Boolean(True, label="Surface")
    mesh_edges: Any = param.Boolean(False, label="Mesh edges")
    interior_edges: Any = param.Boolean(True, label="Interior edges")
    surface_edges: Any = param.Boolean(False, label="Surface edges")

    thin: Any = param.Boolean(True, doc="Show only a thin slice of the interior behind a cut.")
