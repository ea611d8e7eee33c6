"""The lattice, its rays, the winding number, and the graph made of them."""

from .build import build_graph
from .cutcell_graph import INTERIOR, MESH, SURFACE, CutCellGraph
from .lattice import Lattice
from .orientation import inverted_faces
from .slice import RaySlice, slice_rays
from .winding import winding_number

__all__ = [
    "INTERIOR",
    "MESH",
    "SURFACE",
    "CutCellGraph",
    "Lattice",
    "RaySlice",
    "build_graph",
    "inverted_faces",
    "slice_rays",
    "winding_number",
]
