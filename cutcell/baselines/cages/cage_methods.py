"""Weights carried from a cage to the body inside it."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from ...isolated.run import WorkFailedError
from ...method import PAPER, Leaf, check_resolution
from ...rig.checks import check_integer
from ...rig.rig import Rig
from ..body import Body
from ..frame import BaselineBinding, Run, bind_by
from .cage import Cage, make_cage
from .harmonic import harmonic_values
from .mean_value import mean_values

CAGE_RESOLUTION = 32
"""Voxels along the longest side whose hull the cage is."""


def harmonic(
    rig: Rig,
    resolution: int = 64,
    *,
    leaf: Leaf = "extend",
    cage_resolution: int = CAGE_RESOLUTION,
    max_influences: int | None = None,
    threshold: float = 0.0,
) -> BaselineBinding:
    """Bind by harmonic coordinates of an automatic cage, whose vertices follow the nearest bone.

    Parameters
    ----------
    rig : Rig
    resolution : int
        R, cells of the grid along the longest side, 2 to 1024.
    leaf
        See `bone_segments`.
    cage_resolution : int
        Voxels along the longest side, 2 to 1024: the cage is their hull, simplified.
    max_influences, threshold
        See `skinning_weights`.

    Returns
    -------
    BaselineBinding
        Stages "cage", "weights".

    Raises
    ------
    ParameterError
        A parameter is out of its range.

    References
    ----------
    Joshi et al. 2007, "Harmonic coordinates for character articulation".
    """
    resolution = check_resolution(resolution)

    def carry(cage: Cage, body: Body) -> NDArray[np.float64]:
        values = cage.weights(body.joints)
        return harmonic_values(cage.vertices, cage.faces, body.points, values, resolution)

    return _bind(rig, carry, leaf, cage_resolution, max_influences, threshold)


def mean_value(
    rig: Rig,
    *,
    leaf: Leaf = "extend",
    cage_resolution: int = CAGE_RESOLUTION,
    max_influences: int | None = None,
    threshold: float = 0.0,
) -> BaselineBinding:
    """Bind by mean value coordinates of the same cage; negative weights are dropped.

    Parameters
    ----------
    rig, leaf, cage_resolution, max_influences, threshold
        See `harmonic`.

    Returns
    -------
    BaselineBinding
        Stages "cage", "weights".

    Raises
    ------
    ParameterError
        A parameter is out of its range.

    References
    ----------
    Ju, Schaefer & Warren 2005, "Mean value coordinates for closed triangular meshes".
    """

    def carry(cage: Cage, body: Body) -> NDArray[np.float64]:
        values = cage.weights(body.joints)
        return mean_values(cage.vertices, cage.faces, body.points, values)

    return _bind(rig, carry, leaf, cage_resolution, max_influences, threshold)


def _bind(
    rig: Rig,
    carry: Callable[[Cage, Body], NDArray[np.float64]],
    leaf: Leaf,
    cage_resolution: int,
    max_influences: int | None,
    threshold: float,
) -> BaselineBinding:
    cage_resolution = check_integer("cage_resolution", cage_resolution, 2, 1024)
    method = PAPER.with_options(
        resolution=cage_resolution, leaf=leaf, max_influences=max_influences, threshold=threshold
    )

    def solve(body: Body, run: Run) -> NDArray[np.float64]:
        cage, failed, seconds = make_cage(body)
        run.end("cage", seconds)
        if cage is None:
            raise WorkFailedError(failed)
        try:
            return carry(cage, body)
        except WorkFailedError:
            run.end("weights")
            raise

    return bind_by(solve, rig, method)
