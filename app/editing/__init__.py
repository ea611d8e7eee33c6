"""Edits that only the page offers: brush strokes, operations on selections, joints in limbs."""

from cutcell.editing.symmetry import joint_mirror

from .brush import paint_weights
from .limb import cross_section_centre
from .stroke import Brush

__all__ = ["Brush", "cross_section_centre", "joint_mirror", "paint_weights"]
