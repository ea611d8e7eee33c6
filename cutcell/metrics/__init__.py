"""Errors of weights, compared with an artist's (paper section 4.3)."""

from .deformation import TURNED, DeformationError, Turn, Turned, deformation_error
from .weight_error import COUNTS, precision_recall, unweighted, vertex_shares, weight_l1

__all__ = [
    "COUNTS",
    "TURNED",
    "DeformationError",
    "Turn",
    "Turned",
    "deformation_error",
    "precision_recall",
    "unweighted",
    "vertex_shares",
    "weight_l1",
]
