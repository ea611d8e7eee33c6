"""Edits that only the page offers: brush strokes, operations on selections, joints in limbs."""

from .brush import paint_weights
from .limb import cross_section_centre
from .mirror import joint_mirror
from .stroke import Brush

__all__ = ["Brush", "cross_section_centre", "joint_mirror", "paint_weights"]
