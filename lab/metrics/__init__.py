"""Errors of weights, compared with an artist's (paper section 4.3)."""

from cutcell.rig.mesh import COUNTS, vertex_shares

from .clips import ClipError, clip_error
from .crosstalk import Crosstalk, crosstalk, find_gaps
from .deformation import TURNED, DeformationError, Turn, Turned, deformation_error
from .weight_error import precision_recall, unweighted, weight_l1

__all__ = [
    "COUNTS",
    "TURNED",
    "ClipError",
    "Crosstalk",
    "DeformationError",
    "Turn",
    "Turned",
    "clip_error",
    "crosstalk",
    "deformation_error",
    "find_gaps",
    "precision_recall",
    "unweighted",
    "vertex_shares",
    "weight_l1",
]
