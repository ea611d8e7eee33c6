"""A cage around a body: coarse, closed, and bound by itself."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from time import perf_counter

import numpy as np
from numpy.typing import NDArray

from ...geometry.segments import distance_to_segment
from ...isolated.run import LIMIT, WorkFailedError, run_isolated
from ..body import Body, Same
from ..volumes.voxels import PAD, voxelize

FACES = 400
"""Triangles that a cage should have; as many as it takes to contain the whole mesh."""


@dataclass(frozen=True, eq=False)
class Cage:
    """A closed surface around a body.

    Parameters
    ----------
    vertices : array, shape (c, 3)
        In the unit cube, or a little outside.
    faces : array, shape (m, 3)
        Counter-clockwise seen from outside.
    joint : array, shape (c,), int32
        The joint of the bone that is nearest to each vertex in a straight line.
    """

    vertices: NDArray[np.float64]
    faces: NDArray[np.int64]
    joint: NDArray[np.int32]

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
        hull = run_isolated("cage", job, LIMIT, "libigl's cage")
    except WorkFailedError as error:
        return None, str(error), perf_counter() - begin
    vertices = (hull["vertices"] - PAD) / size
    bones = body.bones
    ends = zip(bones.start, bones.end, strict=True)
    distance = np.stack([distance_to_segment(vertices, start, end) for start, end in ends])
    joint = bones.joint[distance.argmin(axis=0)]
    return Cage(vertices, hull["faces"], joint), "", perf_counter() - begin
