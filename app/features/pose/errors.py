"""Differences of two sets of weights as a character moves."""

import numpy as np
from numpy.typing import ArrayLike, NDArray

from cutcell.rig import Clip, Rig, Skeleton, TriangleMesh
from cutcell.runtime.progress import Progress, silent
from cutcell_lab.metrics import DeformationError, deformation_error
from cutcell_lab.metrics.clips import compared_times
from cutcell_viewers.skin import Gap

NEARLY_ALL = 0.995
"""Part of the vertices that `motion_error` calls nearly all."""


def motion_error(clip: Clip, gap: Gap, progress: Progress = silent) -> tuple[float, float, float]:
    """Return the distances between two sets of weights while a clip plays, in the gap's unit.

    Parameters
    ----------
    clip : Clip
        In the space of the gap's points.
    gap : Gap
    progress : callable
        See `cutcell.runtime.progress`.

    Returns
    -------
    rms : float
        Root mean square over frames and vertices.
    greatest : float
    most : float
        What nearly all vertices stay below, in every frame.
    """
    times = compared_times(clip)
    squares = greatest = most = 0.0
    for done, time in enumerate(times):
        progress("error", done / len(times))
        lengths = gap.lengths(clip.sample(time))
        squares += float(np.square(lengths).mean()) / len(times)
        greatest = max(greatest, float(lengths.max()))
        most = max(most, float(np.quantile(lengths, NEARLY_ALL)))
    return float(np.sqrt(squares)), greatest, most


def scene_error(
    rig: Rig, weights: ArrayLike, reference: ArrayLike, progress: Progress = silent
) -> DeformationError:
    """Compute the deformation error with turns about the axes of the scene, where y is up.

    Parameters
    ----------
    rig : Rig
    weights, reference : array_like, shape (n, j)
    progress : callable
        See `cutcell.runtime.progress`.

    Returns
    -------
    DeformationError
    """

    def placed(points: NDArray[np.float64]) -> NDArray[np.float64]:
        return points @ rig.world[:3, :3].T + rig.world[:3, 3]

    mesh, bones = TriangleMesh(placed(rig.mesh.vertices), rig.mesh.faces), rig.skeleton
    skeleton = Skeleton(placed(bones.joints), bones.parents, bones.names, bones.deform)
    return deformation_error((mesh, skeleton), weights, reference, progress=progress)
