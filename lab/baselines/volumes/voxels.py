"""Solid voxels: conservative voxelisation of the surface, then what it encloses."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import label

from cutcell.runtime.compiled import compiled

from ..body import Body

PAD = 2
"""Voxels around the unit cube: one that its faces may touch, one through which the flood runs."""

HALF = 0.5 + 1e-9
"""Half a voxel, and a little: a triangle that lies on the side between two marks both."""

NEIGHBOURS = np.array(
    [(x, y, z) for x in (-1, 0, 1) for y in (-1, 0, 1) for z in (-1, 0, 1) if (x, y, z) > (0, 0, 0)]
)
"""One of each pair of opposite neighbours: 13 of the 26."""


@dataclass(frozen=True, eq=False)
class Voxels:
    """Voxels that a body touches or encloses; two more layers surround the unit cube."""

    solid: NDArray[np.bool_]  # (R + 4, R + 4, R + 4)
    number: NDArray[np.int32]  # the same shape, counts the solid voxels; -1 elsewhere
    centres: NDArray[np.float64]  # (s, 3), of the solid voxels, in the unit cube
    resolution: int  # R

    def at(self, points: NDArray[np.float64]) -> NDArray[np.int32]:
        """Return the number of the solid voxel that contains each point (..., 3), or -1."""
        cell = np.floor(points * self.resolution).astype(np.int64) + PAD
        # The far side of the unit cube belongs to the last voxel inside.
        cell -= (points == 1).astype(np.int64)
        cell = np.clip(cell, 0, self.resolution + 2 * PAD - 1)
        return self.number[tuple(np.moveaxis(cell, -1, 0))]

    def links(
        self, connectivity: Literal[6, 26] = 26
    ) -> tuple[NDArray[np.int32], NDArray[np.float64]]:
        """List neighbours that share a face (6), or an edge or a corner too (26)."""
        pairs, lengths = [], []
        inner = self.number[1:-1, 1:-1, 1:-1]
        for step in NEIGHBOURS[np.abs(NEIGHBOURS).sum(axis=1) <= (1 if connectivity == 6 else 3)]:
            shifted = np.roll(self.number, -step, axis=(0, 1, 2))[1:-1, 1:-1, 1:-1]
            both = (inner >= 0) & (shifted >= 0)
            pairs.append(np.stack([inner[both], shifted[both]], axis=1))
            lengths.append(np.full(len(pairs[-1]), np.linalg.norm(step) / self.resolution))
        return np.concatenate(pairs), np.concatenate(lengths)


def voxelize(body: Body, fill: Literal["flood", "spans"] = "flood") -> Voxels:
    """Mark all voxels that the surface touches, and all that it encloses.

    References
    ----------
    Dionne & de Lasa 2013, section 3.1; the test of triangle and box: Akenine-Möller 2001; spans:
    Zhang et al. 2025 (UniRig).
    """
    resolution = body.lattice.resolution
    surface = np.zeros((resolution + 2 * PAD,) * 3, bool)
    mark_triangles(body.points[body.faces] * resolution + PAD, surface)
    solid = _not_flooded(surface) if fill == "flood" else surface | _in_two_spans(surface)
    number = np.full(solid.shape, -1, np.int32)
    number[solid] = np.arange(solid.sum())
    centres = (np.argwhere(solid) - PAD + 0.5) / resolution
    return Voxels(solid, number, centres, resolution)


def _not_flooded(surface: NDArray[np.bool_]) -> NDArray[np.bool_]:
    # Faces stop the flood, so it runs through sides of voxels only.
    outside = label(~surface)[0]
    solid: NDArray[np.bool_] = outside != outside[0, 0, 0]
    return solid


def _in_two_spans(surface: NDArray[np.bool_]) -> NDArray[np.bool_]:
    count = np.zeros(surface.shape, np.int8)
    for axis in range(3):
        begun = np.logical_or.accumulate(surface, axis=axis)
        ahead = np.flip(np.logical_or.accumulate(np.flip(surface, axis), axis=axis), axis)
        count += begun & ahead
    between: NDArray[np.bool_] = count >= 2
    return between


@compiled
def mark_triangles(triangles, marked):
    """Mark the unit boxes that triangles (m, 3, 3) touch: box (i, j, k) starts at that corner."""
    low, high = np.empty(3, np.int64), np.empty(3, np.int64)
    corners = np.empty((3, 3))
    size = marked.shape[0]
    for t in range(len(triangles)):
        for axis in range(3):
            coordinates = triangles[t, :, axis]
            low[axis] = max(0, int(np.floor(coordinates.min() - 1e-9)))
            high[axis] = min(size - 1, int(np.floor(coordinates.max() + 1e-9)))
        for i in range(low[0], high[0] + 1):
            for j in range(low[1], high[1] + 1):
                for k in range(low[2], high[2] + 1):
                    if marked[i, j, k]:
                        continue
                    for c in range(3):
                        corners[c, 0] = triangles[t, c, 0] - i - 0.5
                        corners[c, 1] = triangles[t, c, 1] - j - 0.5
                        corners[c, 2] = triangles[t, c, 2] - k - 0.5
                    marked[i, j, k] = _touches(corners)


@compiled
def _touches(corners):
    """Whether a triangle meets the unit box around the origin: no axis separates them.

    The box's own axes are not tried: its neighbourhood was chosen by them.
    """
    e0, e1, e2 = corners[1] - corners[0], corners[2] - corners[1], corners[0] - corners[2]
    if _separates(np.cross(e0, e1), corners):
        return False
    axis = np.empty(3)
    for edge in (e0, e1, e2):
        for side in range(3):
            a, b = (side + 1) % 3, (side + 2) % 3
            axis[side] = 0.0
            axis[a] = -edge[b]
            axis[b] = edge[a]
            if _separates(axis, corners):
                return False
    return True


@compiled
def _separates(axis, corners):
    radius = HALF * (abs(axis[0]) + abs(axis[1]) + abs(axis[2]))
    least, most = np.inf, -np.inf
    for c in range(3):
        at = axis[0] * corners[c, 0] + axis[1] * corners[c, 1] + axis[2] * corners[c, 2]
        least, most = min(least, at), max(most, at)
    return least > radius or most < -radius
