"""Skinning weights from geodesic cut-cell graphs (Ma et al. 2026)."""

from importlib import import_module
from typing import Any

__version__ = "0.1.0"

# Where each public name lives. Imported on first use: `import cutcell` stays cheap.
_HOMES = {
    "TriangleMesh": "rig",
    "Skeleton": "rig",
    "Rig": "rig",
    "Clip": "motion",
    "Attachment": "rig",
    "Part": "rig",
    "LeftOut": "rig",
    "deform_joints": "deform",
    "DeformJoints": "deform",
    "choose_deform": "deform",
    "load": "io",
    "save": "io",
    "build_graph": "graph",
    "CutCellGraph": "graph",
    "winding_number": "graph",
    "bone_distances": "geodesics",
    "BoneDistances": "geodesics",
    "bone_segments": "geodesics",
    "skinning_weights": "skinning",
    "bind": "skinning",
    "Binding": "skinning",
    "diagnose": "diagnosis",
    "Diagnosis": "diagnosis",
    "Finding": "diagnosis",
    "forward_kinematics": "pose",
    "linear_blend_skinning": "pose",
    "CutcellError": "errors",
    "FileError": "errors",
    "MeshError": "errors",
    "SkeletonError": "errors",
    "WeightsError": "errors",
    "ParameterError": "errors",
    "TooLargeError": "errors",
    "MissingLibraryError": "errors",
    "Cancelled": "errors",
}
__all__ = sorted([*_HOMES, "__version__"])


def __getattr__(name: str) -> Any:
    if name not in _HOMES:
        raise AttributeError(f"module 'cutcell' has no attribute {name!r}")
    value = getattr(import_module(f".{_HOMES[name]}", __name__), name)
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return __all__
