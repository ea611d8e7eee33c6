"""The cut-cell graph of a mesh (paper section 3.1)."""

from .build import build_graph
from .cutcell_graph import INTERIOR, MESH, SURFACE, CutCellGraph
from .lattice import Lattice
from .orientation.orient import inverted_faces

__all__ = [
    "INTERIOR",
    "MESH",
    "SURFACE",
    "CutCellGraph",
    "Lattice",
    "build_graph",
    "inverted_faces",
]
