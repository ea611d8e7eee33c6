"""Edits by people: layers of weights, the skeleton, symmetry."""

from .edited import edited_rig
from .edits import Edits, JointEdit
from .layers.contents import (
    Attached,
    Computed,
    Filled,
    FromFile,
    Locked,
    Mirrored,
    Remapped,
    Smoothed,
)
from .layers.layer import Layer, Mask
from .layers.painted import Painted
from .poses import SavedPose
from .refine import refine_weights

__all__ = [
    "Attached",
    "Computed",
    "Edits",
    "Filled",
    "FromFile",
    "JointEdit",
    "Layer",
    "Locked",
    "Mask",
    "Mirrored",
    "Painted",
    "Remapped",
    "SavedPose",
    "Smoothed",
    "edited_rig",
    "refine_weights",
]
