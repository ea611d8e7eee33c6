"""Weights carried from a cage to the body inside it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache, partial
from time import perf_counter

import numpy as np
from numpy.typing import NDArray

from cutcell.checks import check_integer
from cutcell.geometry.segments import distance_to_segment
from cutcell.isolated.run import LIMIT, WorkFailedError, run_isolated
from cutcell.method import PAPER, Leaf, check_resolution
from cutcell.rig import Rig

from ..body import Body, Same
from ..frame import BaselineBinding, Run, bind_by
from ..volumes.voxels import PAD, voxelize
from .harmonic import harmonic_values
from .mean_value import mean_values

CAGE_RESOLUTION = 32
"""Voxels along the longest side whose hull the cage is."""


FACES = 400
"""Triangles that a cage should have; as many as it takes to contain the whole mesh."""


@dataclass(frozen=True, eq=False)
class Cage:
    """A closed surface around a body, in the unit cube or a little outside."""

    vertices: NDArray[np.float64]  # (c, 3)
    faces: NDArray[np.int64]  # (m, 3), oriented outwards
    joint: NDArray[np.int32]  # (c,), of the bone nearest to each vertex in a straight line

    def weights(self, joints: int) -> NDArray[np.float64]:
        """Return the weights of the vertices, shape (c, joints): each follows its joint."""
        result = np.zeros((len(self.joint), joints))
        result[np.arange(len(self.joint)), self.joint] = 1
        return result


def make_cage(body: Body) -> tuple[Cage | None, str, float]:
    """Wrap a body in the simplified hull of its voxels, one and a half of them away.

    Parts that are nearer to each other than three voxels become one: the body's lattice
    says how large these are. The last cage made is remembered.
    """
    return _make(Same(body, body.lattice.resolution))


@lru_cache(maxsize=2)
def _make(key: Same) -> tuple[Cage | None, str, float]:
    body = key.body
    begin = perf_counter()
    size = body.lattice.resolution
    used = body.points[np.unique(body.faces)]
    job = {"solid": voxelize(body).solid, "points": used * size + PAD, "faces": FACES}
    try:
        hull = run_isolated(
            "cutcell_lab.isolated.cage:make_cage",
            job,
            LIMIT,
            "libigl's cage",
            extra="cutcell[copyleft]",
        )
    except WorkFailedError as error:
        return None, str(error), perf_counter() - begin
    vertices = (hull["vertices"] - PAD) / size
    bones = body.bones
    ends = zip(bones.start, bones.end, strict=True)
    distance = np.stack([distance_to_segment(vertices, start, end) for start, end in ends])
    joint = bones.joint[distance.argmin(axis=0)]
    return Cage(vertices, hull["faces"], joint), "", perf_counter() - begin


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

    carry = partial(harmonic_values, resolution=resolution)
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
    return _bind(rig, mean_values, leaf, cage_resolution, max_influences, threshold)


def _bind(
    rig: Rig,
    carry: Callable[..., NDArray[np.float64]],
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
            return carry(cage.vertices, cage.faces, body.points, cage.weights(body.joints))
        except WorkFailedError:
            run.end("weights")
            raise

    return bind_by(solve, rig, method)
