"""Slices of the lattice of a mesh."""

from .ray_slice import RaySlice, slice_rays

__all__ = ["RaySlice", "slice_rays"]
