"""Moving a rig: kinematics of the joints, blending of the vertices, clips."""

from .dual_quaternions import dual_quaternion_skinning
from .kinematics import (
    axis_rotation,
    forward_kinematics,
    linear_blend_skinning,
    pose_at,
    rotate_joint,
    swing,
)

__all__ = [
    "axis_rotation",
    "dual_quaternion_skinning",
    "forward_kinematics",
    "linear_blend_skinning",
    "pose_at",
    "rotate_joint",
    "swing",
]
