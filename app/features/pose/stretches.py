"""The edge of the surface that stretches most in each of some poses."""

from collections.abc import Iterator, Mapping
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from cutcell.editing import SavedPose
from cutcell.errors import CutcellError
from cutcell.rig import Rig
from cutcell.runtime.progress import Progress, silent
from cutcell_lab.metrics.clips import compared_times
from cutcell_lab.metrics.deformation import longest_side
from cutcell_viewers.skin import Blending, Skin

from ...looks.pose import saved_pose

SHORTEST = 1e-3
"""Least length of an edge at rest, as part of the longest side: others are too short to be seen."""

Poses = Mapping[str, SavedPose]
Key = str | int
"""Name of a saved pose, or number of a clip."""


class Worst(NamedTuple):
    """The edge that stretches most.

    Parameters
    ----------
    factor : float
        How many times as long as at rest it becomes.
    vertex : int
        An end of it, in the file.
    seconds : float
        When, in a clip.
    """

    factor: float
    vertex: int
    seconds: float = 0.0


def worst_edges(
    rig: Rig,
    weights: NDArray[np.float64],
    blending: Blending,
    poses: Poses | None,
    progress: Progress = silent,
) -> dict[Key, Worst]:
    """Return the edge that stretches most in each saved pose, or in each clip of the rig.

    Edges at vertices whose row is all zero are left out: they are a finding of their own.

    Parameters
    ----------
    rig : Rig
    weights : array, shape (n, j)
    blending : {"linear", "dual"}
    poses : mapping or None
        See `Edits.poses`; None for the frames of the clips that `clip_error` compares, too.
    progress : callable
        See `cutcell.runtime.progress`.
    """
    mesh, welded = rig.mesh, rig.mesh.welded
    is_weighted = np.asarray(weights[welded.first].any(axis=1))
    edges = welded.edges.edges[is_weighted[welded.edges.edges].all(axis=1)]
    if not len(edges):
        return {}
    ends = np.unique(edges)
    vertices, (start, end) = welded.first[ends], np.searchsorted(ends, edges.T)
    points, skin = mesh.vertices[vertices], Skin.of_weights(weights[vertices])
    before = np.linalg.norm(points[start] - points[end], axis=1)
    before = np.maximum(before, SHORTEST * longest_side(mesh))
    result: dict[Key, Worst] = {}
    for done, key, seconds, pose in _moments(rig, poses):
        progress("stretch of the poses", done)
        moved = skin.move(points, pose, blending)
        stretch = np.linalg.norm(moved[start] - moved[end], axis=1) / before
        edge = int(stretch.argmax())
        if key not in result or stretch[edge] > result[key].factor:
            result[key] = Worst(float(stretch[edge]), int(vertices[start[edge]]), seconds)
    return result


def _moments(rig: Rig, poses: Poses | None) -> Iterator[tuple[float, Key, float, NDArray]]:
    """Yield the part that is done, a key, a time, and the skinning matrices (j, 4, 4)."""
    if poses is not None:
        for place, (name, pose) in enumerate(poses.items()):
            yield place / len(poses), name, 0.0, saved_pose(rig, pose)
        return
    for number, clip in enumerate(rig.clips):
        times = compared_times(clip)
        try:
            frames = clip.sample(times)
        except CutcellError:  # it is reported where the clip is played
            continue
        for place, (seconds, pose) in enumerate(zip(times.tolist(), frames, strict=True)):
            yield (number + place / len(times)) / len(rig.clips), number, seconds, pose
