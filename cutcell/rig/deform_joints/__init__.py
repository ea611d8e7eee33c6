"""Which joints move the skin, told without any weights, and chosen by a person."""

from .guess import DeformJoints, choose_deform, deform_joints

__all__ = ["DeformJoints", "choose_deform", "deform_joints"]
