"""Errors of weights, compared with an artist's (paper section 4.3)."""

from .clips import ClipError, clip_error
from .counting import COUNTS, vertex_shares
from .crosstalk import Crosstalk, crosstalk, find_gaps
from .deformation import TURNED, DeformationError, Turn, Turned, deformation_error
from .per_joint import JointRow, joint_table
from .weight_error import precision_recall, unweighted, weight_l1

__all__ = [
    "COUNTS",
    "TURNED",
    "ClipError",
    "Crosstalk",
    "DeformationError",
    "JointRow",
    "Turn",
    "Turned",
    "clip_error",
    "crosstalk",
    "deformation_error",
    "find_gaps",
    "joint_table",
    "precision_recall",
    "unweighted",
    "vertex_shares",
    "weight_l1",
]
