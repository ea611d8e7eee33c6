"""Manual edits: corrections, locks, symmetry, smoothing, and the steps of a binding."""

from .bind import bind
from .correct import corrected_rig
from .corrections import Corrections, JointCorrection, PartCorrection
from .explain import Explanation, JointShare, Piece, explain
from .refine import refine_weights

__all__ = [
    "Corrections",
    "Explanation",
    "JointCorrection",
    "JointShare",
    "PartCorrection",
    "Piece",
    "bind",
    "corrected_rig",
    "explain",
    "refine_weights",
]
