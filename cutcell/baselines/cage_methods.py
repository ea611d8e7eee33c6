"""Weights carried from a cage to the body inside it."""

from __future__ import annotations

from collections.abc import Callable
from time import perf_counter

import numpy as np
from numpy.typing import NDArray

from ..apart import WorkFailedError
from ..checks import check_integer
from ..rig import Rig
from .body import Body
from .cage import Cage, make_cage
from .harmonic import harmonic_values
from .mean_value import mean_values
from .result import BaselineBinding, finish

CAGE_RESOLUTION = 32
"""Voxels along the longest side whose hull the cage is."""


def harmonic(
    rig: Rig,
    resolution: int = 64,
    *,
    leaf: str = "extend",
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
    resolution = check_integer("resolution", resolution, 2, 1024)

    def carry(cage: Cage, body: Body) -> NDArray[np.float64]:
        values = cage.weights(body.joints)
        return harmonic_values(cage.vertices, cage.faces, body.points, values, resolution)

    return _bind(rig, carry, leaf, cage_resolution, max_influences, threshold)


def mean_value(
    rig: Rig,
    *,
    leaf: str = "extend",
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
    leaf: str,
    cage_resolution: int,
    max_influences: int | None,
    threshold: float,
) -> BaselineBinding:
    cage_resolution = check_integer("cage_resolution", cage_resolution, 2, 1024)
    body = Body.of(rig, leaf, cage_resolution)
    cage, failed, making = make_cage(body)
    seconds = {"cage": making}
    if cage is None:
        return BaselineBinding(None, seconds, failed=failed)
    begin = perf_counter()
    try:
        weights = carry(cage, body)
    except WorkFailedError as error:
        seconds["weights"] = perf_counter() - begin
        return BaselineBinding(None, seconds, failed=str(error))
    weights, warnings = finish(
        rig, body, weights, max_influences=max_influences, threshold=threshold
    )
    seconds["weights"] = perf_counter() - begin
    return BaselineBinding(weights, seconds, warnings)
