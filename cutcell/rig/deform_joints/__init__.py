"""Which joints move the skin, told without any weights, and chosen by a person."""

from .choose import choose_deform
from .guess import DeformJoints, deform_joints

__all__ = ["DeformJoints", "choose_deform", "deform_joints"]
