"""Bones, their distances through the body, and what to do where there are none."""

from ..bones.bones import Bones, Sources, bone_samples, bone_segments
from ..method import LEAVES
from .distances import BoneDistances, bone_distances
from .fallback import FALLBACK_REASONS
from .solver import BoneDistanceSolver
from .tracing.paths import PIECES, TracedPath, trace_path

__all__ = [
    "FALLBACK_REASONS",
    "LEAVES",
    "PIECES",
    "BoneDistanceSolver",
    "BoneDistances",
    "Bones",
    "Sources",
    "TracedPath",
    "bone_distances",
    "bone_samples",
    "bone_segments",
    "trace_path",
]
