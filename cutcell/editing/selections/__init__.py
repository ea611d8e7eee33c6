"""Selections of vertices: along the mesh, by joints, by a condition."""

from .condition import vertices_where
from .neighbours import Neighbours

__all__ = ["Neighbours", "vertices_where"]
