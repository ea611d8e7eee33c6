"""Joints that move the skin: guessed without weights, or chosen by a person."""

from .choice import choose_deform
from .guess import DeformJoints, deform_joints

__all__ = ["DeformJoints", "choose_deform", "deform_joints"]
