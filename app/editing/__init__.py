"""Edits that only the page offers: brush strokes, joints centred in limbs, mirrored joints."""

from .brush import paint_weights
from .limb import cross_section_centre
from .mirror import find_joint_mirror
from .stroke import Brush

__all__ = ["Brush", "cross_section_centre", "find_joint_mirror", "paint_weights"]
