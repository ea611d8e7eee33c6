"""The error over a character's own motions."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from cutcell.pose import linear_blend_skinning
from cutcell.rig import Rig
from cutcell.rig.mesh import vertex_shares

from .deformation import CM2, check_fit, longest_side
from .weight_error import checked_pair

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
    rig.require_joints()
    weights, targets = checked_pair(predicted, reference)
    check_fit(weights, rig.mesh, rig.skeleton)
    share = vertex_shares(rig.mesh, count)
    unit = CM2 / longest_side(rig.mesh) ** 2
    errors = []
    for clip in rig.clips:
        times = clip.times
        chosen = np.unique(np.linspace(0, len(times) - 1, FRAMES).round().astype(int))
        chosen = chosen[chosen >= 0]
        largest, total = np.zeros(len(weights)), 0.0
        for frame in chosen:
            transforms = clip.sample(times[frame])
            difference = linear_blend_skinning(rig.mesh.vertices, weights, transforms)
            difference -= linear_blend_skinning(rig.mesh.vertices, targets, transforms)
            squared = unit * (difference * difference).sum(axis=1)
            largest = np.maximum(largest, squared)
            total += float(share @ squared)
        mean = total / max(len(chosen), 1)
        errors.append(ClipError(clip.name, len(chosen), mean, float(share @ largest)))
    return tuple(errors)
