"""Layers of weights: their contents as data, and their application to arrays."""

from .apply import apply_layers, blended
from .sources import RigSources, vertices_of

__all__ = ["RigSources", "apply_layers", "blended", "vertices_of"]
