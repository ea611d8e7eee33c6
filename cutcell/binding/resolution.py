"""The resolution of files that hold several characters."""

from __future__ import annotations

import numpy as np

from ..animation.bone_extents.skins import characters, share_a_skin
from ..graph import CutCellGraph
from ..method import MAX_RESOLUTION, Method
from ..rig import Rig

SIDE_BY_SIDE = 1.25
"""Smallest ratio of the length of several characters to that of the largest of them."""
MAX_REFINEMENT = 4
"""Rays are as many as the square of the resolution, so characters far apart are bound coarser."""


def method_per_character(rig: Rig, method: Method, graph: CutCellGraph | None = None) -> Method:
    """Return a method whose resolution counts along the largest of several characters in a file.

    Each is then bound as if it were alone. Characters share no joint. A graph that was built at
    the method's own resolution stays in use.
    """
    is_built = graph is not None and graph.lattice.resolution == method.resolution
    if rig.allowed is None or method.falloff != "rig" or is_built:
        return method
    joints = characters(rig.skeleton, share_a_skin(rig.allowed, len(rig.skeleton.joints)))
    parts = [rig.mesh.vertices[rig.allowed[:, one].any(axis=1)] for one, _ in joints]
    longest = max((np.ptp(part, axis=0).max() for part in parts if len(part)), default=0.0)
    whole = np.ptp(rig.mesh.vertices, axis=0).max()
    if not 0 < SIDE_BY_SIDE * longest < whole:
        return method
    resolution = round(min(whole / longest, MAX_REFINEMENT) * method.resolution)
    return method.with_options(resolution=min(resolution, MAX_RESOLUTION))
