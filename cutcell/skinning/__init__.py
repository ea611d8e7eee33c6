"""Weights from distances, and all stages from a rig to its weights."""

from .bind import Binding, bind
from .brush import paint_weights
from .compilation import is_compiled, warm_up
from .correct import corrected_rig
from .explain import Explanation, JointShare, Piece, explain
from .limb import middle_of_limb
from .refine import refine_weights
from .stroke import Brush
from .weights import keep_strongest, skinning_weights

__all__ = [
    "Binding",
    "Brush",
    "Explanation",
    "JointShare",
    "Piece",
    "bind",
    "corrected_rig",
    "explain",
    "is_compiled",
    "keep_strongest",
    "middle_of_limb",
    "paint_weights",
    "refine_weights",
    "skinning_weights",
    "warm_up",
]
