"""Manual edits: corrections, brush strokes, locks, symmetry, smoothing."""

from .brush import paint_weights
from .correct import corrected_rig
from .corrections import Corrections, JointCorrection, PartCorrection
from .explain import Explanation, JointShare, Piece, explain
from .limb import cross_section_centre
from .refine import refine_weights
from .stroke import Brush

__all__ = [
    "Brush",
    "Corrections",
    "Explanation",
    "JointCorrection",
    "JointShare",
    "PartCorrection",
    "Piece",
    "corrected_rig",
    "cross_section_centre",
    "explain",
    "paint_weights",
    "refine_weights",
]
