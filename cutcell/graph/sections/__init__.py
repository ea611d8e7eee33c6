"""Sections of a mesh by a plane, slices of its lattice, and fields on them."""

from .interpolation import interpolate
from .plane_section import PlaneSection, plane_outline, plane_section
from .ray_slice import RaySlice, slice_rays

__all__ = [
    "PlaneSection",
    "RaySlice",
    "interpolate",
    "plane_outline",
    "plane_section",
    "slice_rays",
]
