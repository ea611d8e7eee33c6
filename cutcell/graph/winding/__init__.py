"""Winding numbers, and the intervals of the lattice's rays where they are at least tau."""

from .exact import winding_number

__all__ = ["winding_number"]
