"""Moving a rig: kinematics of the joints, blending of the vertices, clips."""

from .blend import linear_blend_skinning
from .clips import pose_at, swing
from .kinematics import axis_rotation, forward_kinematics, rotate_joint

__all__ = [
    "axis_rotation",
    "forward_kinematics",
    "linear_blend_skinning",
    "pose_at",
    "rotate_joint",
    "swing",
]
