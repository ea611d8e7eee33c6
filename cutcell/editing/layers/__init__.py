"""Layers of weights: their contents as data, and their application to arrays."""

from .apply import apply_layers, blended, strength_of
from .sources import RigSources, vertices_of
from .stacked import StackedRows

__all__ = [
    "RigSources",
    "StackedRows",
    "apply_layers",
    "blended",
    "strength_of",
    "vertices_of",
]
