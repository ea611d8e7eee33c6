"""Which intervals of the lattice's rays lie inside: those of winding number at least tau."""

from .exact import winding_number
from .intervals import InsideIntervals, inside_intervals

__all__ = ["InsideIntervals", "inside_intervals", "winding_number"]
