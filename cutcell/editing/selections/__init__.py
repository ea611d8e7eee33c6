"""Selections of vertices along the mesh."""

from .neighbours import Neighbours

__all__ = ["Neighbours"]
