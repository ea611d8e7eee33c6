"""Joints that move the skin: guessed without weights, or chosen by a person."""

from .guess import DeformJoints, choose_deform, deform_joints

__all__ = ["DeformJoints", "choose_deform", "deform_joints"]
