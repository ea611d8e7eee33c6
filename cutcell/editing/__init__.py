"""Edits by people: layers of weights, the skeleton, symmetry; and the steps of a binding."""

from .bind import bind
from .edited import edited_rig
from .edits import Edits, JointEdit
from .explain import Explanation, JointShare, Piece, explain
from .layers.contents import Attached, Computed, Filled, FromFile, Locked, Mirrored, Smoothed
from .layers.layer import Layer, Mask
from .layers.painted import Painted
from .refine import refine_weights

__all__ = [
    "Attached",
    "Computed",
    "Edits",
    "Explanation",
    "Filled",
    "FromFile",
    "JointEdit",
    "JointShare",
    "Layer",
    "Locked",
    "Mask",
    "Mirrored",
    "Painted",
    "Piece",
    "Smoothed",
    "bind",
    "edited_rig",
    "explain",
    "refine_weights",
]
