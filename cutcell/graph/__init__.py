"""The lattice, its rays, the winding number, and the graph made of them."""

from .build import build_graph
from .cutcell_graph import INTERIOR, MESH, SURFACE, CutCellGraph
from .lattice import Lattice
from .segments import kernels_are_compiled
from .winding import winding_number

__all__ = [
    "INTERIOR",
    "MESH",
    "SURFACE",
    "CutCellGraph",
    "Lattice",
    "build_graph",
    "kernels_are_compiled",
    "winding_number",
]
