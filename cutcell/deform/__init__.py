"""Which joints move the skin, told without any weights."""

from .guess import DeformJoints, deform_joints

__all__ = ["DeformJoints", "deform_joints"]
