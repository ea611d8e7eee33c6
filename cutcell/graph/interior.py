"""The lattice points inside the body, numbered column by column without an R^3 table.

The intervals along z list them already: a column of the lattice has few intervals, so the number of
a point is that of the first point of its interval plus the offset.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..runtime.compiled import inlined, no_refcount
from ..runtime.threads import in_threads
from .rays import in_space
from .segments import InsideIntervals

OUTSIDE = -1


@dataclass(frozen=True, eq=False)
class InteriorPoints:
    """Lattice points with at least one kept segment, ascending by (x, y, z).

    Parameters
    ----------
    resolution : int
        R.
    start : array, shape (R * R + 1,), int64
        The stretches of column x * R + y are those from start[x * R + y] on.
    first, last : arrays, shape (s,), int32
        Lowest and highest z of each stretch of consecutive points.
    number : array, shape (s + 1,), int64
        The number of points before each stretch.
    """

    resolution: int
    start: NDArray[np.int64]
    first: NDArray[np.int32]
    last: NDArray[np.int32]
    number: NDArray[np.int64]

    def __len__(self) -> int:
        return int(self.number[-1])

    @property
    def table(self) -> tuple[NDArray, NDArray, NDArray, NDArray]:
        """The arrays that `point_number` takes."""
        return self.start, self.first, self.last, self.number

    def put_positions(self, out: NDArray[np.float64]) -> None:
        """Write the positions of the points in the unit cube into an array (len, 3)."""
        count = self.last - self.first + 1
        column = np.repeat(np.arange(self.resolution**2), np.diff(self.start))
        out[:, 0] = np.repeat((column // self.resolution + 0.5) / self.resolution, count)
        out[:, 1] = np.repeat((column % self.resolution + 0.5) / self.resolution, count)
        z = np.arange(len(self)) + np.repeat(self.first - self.number[:-1], count)
        out[:, 2] = (z + 0.5) / self.resolution


def interior_points(inside: Sequence[InsideIntervals], resolution: int) -> InteriorPoints:
    """Collect the lattice points of the intervals along x, y and z."""
    along_z = inside[2]
    points = _number_stretches(along_z.ray, along_z.first, along_z.last, resolution)
    # Where the surface passes through a lattice point, or an open mesh's winding number is close
    # to the threshold, a point may have kept segments along x or y only.

    def missed_along(axis: int) -> NDArray[np.int64]:
        ray, first, last = inside[axis].ray, inside[axis].first, inside[axis].last
        missed = np.empty(int((last - first + 1).sum()), np.int64)
        count = _missed_points(ray, first, last, axis, resolution, *points.table, missed)
        return missed[:count]

    extra = np.unique(np.concatenate(in_threads(missed_along, (0, 1))))
    if len(extra) == 0:
        return points
    single = (extra % resolution).astype(np.int32)
    column = np.concatenate([along_z.ray, (extra // resolution).astype(np.int32)])
    first, last = (np.concatenate([a, single]) for a in (along_z.first, along_z.last))
    order = np.lexsort((first, column))
    return _number_stretches(column[order], first[order], last[order], resolution)


def _number_stretches(
    column: NDArray[np.int32], first: NDArray[np.int32], last: NDArray[np.int32], resolution: int
) -> InteriorPoints:
    """Drop empty stretches, shapes (s,); count those and the points before each."""
    is_filled = first <= last
    column, first, last = column[is_filled], first[is_filled], last[is_filled]
    start = np.append(0, np.cumsum(np.bincount(column, minlength=resolution * resolution)))
    number = np.append(0, np.cumsum(last - first + 1, dtype=np.int64))
    return InteriorPoints(resolution, start, first, last, number)


@inlined
def point_number(start, first, last, number, column, z):
    """Return the number of the point at z in a column, or OUTSIDE."""
    for s in range(start[column], start[column + 1]):
        if first[s] <= z <= last[s]:
            return number[s] + z - first[s]
    return np.int64(OUTSIDE)


@inlined
def point_on_ray(axis, ray, k, resolution):
    """Return column and z of the lattice point k on a ray."""
    x, y, z = in_space(axis, ray // resolution, ray % resolution, k)
    return x * resolution + y, z


@no_refcount
def _missed_points(ray, first_k, last_k, axis, resolution, start, first, last, number, missed):
    """List the lattice numbers of the points along one axis that the columns lack."""
    count = 0
    for r in range(len(ray)):
        for k in range(first_k[r], last_k[r] + 1):
            column, z = point_on_ray(axis, ray[r], k, resolution)
            if point_number(start, first, last, number, column, z) == OUTSIDE:
                missed[count] = column * resolution + z
                count += 1
    return count
