"""The lattice, its rays, the winding number, and the graph made of them."""

from .build import build_graph
from .cutcell_graph import INTERIOR, MESH, SURFACE, CutCellGraph
from .lattice import Lattice
from .winding import winding_number

__all__ = [
    "INTERIOR",
    "MESH",
    "SURFACE",
    "CutCellGraph",
    "Lattice",
    "build_graph",
    "winding_number",
]
