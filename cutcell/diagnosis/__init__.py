"""Faults of rigs: checks that name the elements at fault, and repairs."""

from .cleaning import Cleaned, JointLoss, clean
from .finding import SEVERITIES, Finding, Pose
from .kinds import TITLES
from .repair import Repaired
from .run import Diagnosis, diagnose, unreadable

__all__ = [
    "SEVERITIES",
    "TITLES",
    "Cleaned",
    "Diagnosis",
    "Finding",
    "JointLoss",
    "Pose",
    "Repaired",
    "clean",
    "diagnose",
    "unreadable",
]
