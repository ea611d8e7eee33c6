"""The error over a character's own motions."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from cutcell.pose import linear_blend_skinning
from cutcell.rig import Clip, Rig, TriangleMesh
from cutcell.rig.mesh import vertex_shares

from .deformation import CM2, checked_fit, longest_side

FRAMES = 24
"""Frames of each clip that are compared, evenly spread, at most."""


@dataclass(frozen=True)
class ClipError:
    """Difference of two sets of weights while a clip plays; cm², the longest side being 1 m.

    Parameters
    ----------
    name : str
        Name of the clip.
    frames : int
        Number of compared frames.
    mean : float
        Squared distance, averaged over frames and vertices.
    largest : float
        The greatest over the frames of each vertex, averaged over the vertices: the measure
        of the deformation error.
    """

    name: str
    frames: int
    mean: float
    largest: float


def clip_error(
    rig: Rig,
    predicted: ArrayLike,
    reference: ArrayLike,
    *,
    count: str = "welded",
) -> tuple[ClipError, ...]:
    """Play every clip of a rig with both weights and compare where the surface goes.

    Parameters
    ----------
    rig : Rig
    predicted, reference : array_like, shape (n, j)
        Rows sum to one, or to zero: such vertices stay at their rest position.
    count : {"welded", "vertices"}
        See `vertex_shares`.

    Returns
    -------
    tuple of ClipError
        One a clip, in their order; empty where the rig has none.

    Raises
    ------
    SkeletonError
        No joints.
    WeightsError
        Weights that do not fit the rig or each other.
    ParameterError
        An unknown `count`.
    """
    weights, targets = checked_fit(rig, predicted, reference)
    share = vertex_shares(rig.mesh, count)
    errors = []
    for clip in rig.clips:
        times = compared_times(clip)
        largest, total = np.zeros(len(weights)), 0.0
        for time in times:
            transforms = clip.sample(time)
            squared = CM2 * squared_distances(rig.mesh, weights, targets, transforms)
            largest = np.maximum(largest, squared)
            total += float(share @ squared)
        mean = total / max(len(times), 1)
        errors.append(ClipError(clip.name, len(times), mean, float(share @ largest)))
    return tuple(errors)


def squared_distances(
    mesh: TriangleMesh,
    weights: NDArray[np.float64],
    targets: NDArray[np.float64],
    transforms: NDArray[np.float64],
) -> NDArray[np.float64]:
    """Return the squared distance (n,) of each posed vertex; the longest side being 1."""
    difference = linear_blend_skinning(mesh.vertices, weights, transforms)
    difference -= linear_blend_skinning(mesh.vertices, targets, transforms)
    return (difference * difference).sum(axis=1) / longest_side(mesh) ** 2


def compared_times(clip: Clip) -> NDArray[np.float64]:
    """Return the times of a clip's compared frames, shape (f,)."""
    frames = np.unique(np.linspace(0, len(clip.times) - 1, FRAMES).round().astype(int))
    return clip.times[frames[frames >= 0]]
