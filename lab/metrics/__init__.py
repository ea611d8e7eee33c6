"""Errors of weights, compared with an artist's (paper section 4.3)."""

from cutcell.rig.mesh import COUNTS, vertex_shares

from .clips import ClipError, clip_error
from .crosstalk import Crosstalk, crosstalk, find_gaps
from .definitions import DEFINITIONS, Definition, errors_by_definition
from .deformation import TURNED, DeformationError, Turn, Turned, deformation_error
from .poses import PoseError, pose_error
from .table import METRICS, Measured, Metric
from .weight_error import precision_recall, unweighted, weight_l1

__all__ = [
    "COUNTS",
    "DEFINITIONS",
    "METRICS",
    "TURNED",
    "ClipError",
    "Crosstalk",
    "Definition",
    "DeformationError",
    "Measured",
    "Metric",
    "PoseError",
    "Turn",
    "Turned",
    "clip_error",
    "crosstalk",
    "deformation_error",
    "errors_by_definition",
    "find_gaps",
    "pose_error",
    "precision_recall",
    "unweighted",
    "vertex_shares",
    "weight_l1",
]
