"""Squared Chamfer distances of many pairs, exact where they are small (paper, algorithms 3 and 4).

D(A, B) = mean over a of min |a - b|² + mean over b of min |b - a|². Pairs at or above a limit are
excluded, most of them by lower bounds of D; `docs/dataset.md` proves them.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from cutcell.runtime.compiled import compiled

from .points import Normalised

CELLS = 16
"""Cells along each side of the unit cube, for the bound on surfaces."""
CODE = 0.006
"""Distances from cells are kept as multiples of this, rounded down, in one byte."""
QUANTILE = 0.99
SLACK = 1 + 1e-9
"""A bound must exceed the limit by this factor: it is computed with rounding, too."""


@dataclass(frozen=True, eq=False)
class Block:
    """Characters in the form of the kernels; all have as many points."""

    joints: NDArray[np.float32]
    """Joints of all characters, concatenated, the outermost of each first, (k, 3)."""
    start: NDArray[np.int64]
    """First joint of each character, (n + 1,)."""
    boxes: NDArray[np.float64]
    """Bounds of the joints, (n, 2, 3)."""
    centres: NDArray[np.float64]
    """Mean of the joints, (n, 3)."""
    points: NDArray[np.float32]
    """On the surface, in the unit cube, sorted by cell, (n, p, 3)."""
    cells: NDArray
    """Cell of each point, (n, p), uint16."""
    first: NDArray
    """First point of each cell, (n, CELLS³ + 1), uint16 or uint32."""
    near: NDArray[np.uint8]
    """Distance of each cell from the nearest point in multiples of `CODE`, (n, CELLS³)."""
    spacing: NDArray[np.float64]
    """The 99th percentile of the distance from a point to the nearest other, (n,)."""

    def __len__(self) -> int:
        return len(self.start) - 1


def block_of(characters: Sequence[Normalised]) -> Block:
    """Prepare characters for comparison; all have as many points."""
    joints = []
    for one in characters:
        away = ((one.joints - one.joints.mean(axis=0)) ** 2).sum(axis=1)
        joints.append(one.joints[np.argsort(-away, kind="stable")])
    start = np.concatenate([[0], np.cumsum([len(j) for j in joints])])
    boxes = np.array([[j.min(axis=0), j.max(axis=0)] for j in joints], np.float64)
    centres = np.array([j.astype(np.float64).mean(axis=0) for j in joints])
    points = np.stack([one.points for one in characters])
    index = np.clip((points * CELLS).astype(np.int32), 0, CELLS - 1)
    cells = (index[..., 0] * CELLS + index[..., 1]) * CELLS + index[..., 2]
    order = np.argsort(cells, axis=1, kind="stable")
    points = np.take_along_axis(points, order[..., None], axis=1)
    cells = np.take_along_axis(cells, order, axis=1).astype(np.uint16)
    kind = np.uint16 if points.shape[1] < 2**16 else np.uint32
    every = np.arange(CELLS**3 + 1)
    first = np.array([np.searchsorted(row, every) for row in cells]).astype(kind)
    near = np.empty((len(points), CELLS**3), np.uint8)
    for k in range(len(points)):
        _distances_of_cells(points[k], first[k], np.unique(cells[k]).astype(np.int64), near[k])
    spacing = np.array([_spacing(one) for one in points])
    return Block(np.concatenate(joints), start, boxes, centres, points, cells, first, near, spacing)


def _spacing(points: NDArray[np.float32]) -> float:
    distances = cKDTree(points).query(points, k=2)[0][:, 1]
    return float(np.quantile(distances, QUANTILE))


def close_joints(
    a: Block, b: Block, limit: float, same: bool
) -> tuple[NDArray[np.int32], NDArray[np.float64]]:
    """Find the pairs whose joints are closer than a limit: stage 1.

    Returns shapes pairs (c, 2), distances (c,).
    """
    pairs = np.empty((len(a) * len(b), 2), np.int32)
    distances = np.empty(len(pairs))
    count = _close_joints(
        a.joints, a.start, a.boxes, a.centres, b.joints, b.start, b.boxes, b.centres,
        limit, same, pairs, distances,
    )  # fmt: skip
    return pairs[:count].copy(), distances[:count].copy()


def close_surfaces(
    a: Block, b: Block, pairs: NDArray[np.int32], limit: float
) -> NDArray[np.float64]:
    """Compute how far apart the surfaces of pairs are: stage 2.

    Shapes: pairs (c, 2); returns (c,).
    """
    distances = np.empty(len(pairs))
    _close_surfaces(
        a.points, a.cells, a.first, a.near, b.points, b.cells, b.first, b.near,
        pairs, limit, distances,
    )  # fmt: skip
    return distances


def reach_of(a: Block, b: Block, pairs: NDArray[np.int32]) -> NDArray[np.float64]:
    """Measure the overhang of one surface of each pair beyond the other, shape (c,).

    The farthest hundredth of the points is left out, and the spacing of the other's points is
    taken off: 0 for two samples of one surface.
    """
    reach = np.empty(len(pairs))
    squares = np.empty(a.points.shape[1]), np.empty(b.points.shape[1])
    for k, (i, j) in enumerate(pairs.tolist()):
        _nearest_squares(a.points[i], b.points[j], b.first[j], squares[0])
        _nearest_squares(b.points[j], a.points[i], a.first[i], squares[1])
        forward, backward = (np.sqrt(np.quantile(square, QUANTILE)) for square in squares)
        reach[k] = max(forward - b.spacing[j], backward - a.spacing[i], 0)
    return reach


@compiled
def _distances_of_cells(points, first, occupied, near):
    """Write how far each cell of the lattice is from the nearest point, rounded down."""
    side = 1.0 / CELLS
    nearest = 0
    for cell in range(len(near)):
        x, y, z = cell // CELLS // CELLS, cell // CELLS % CELLS, cell % CELLS
        least = np.inf
        for k in range(-1, len(occupied)):
            which = nearest if k < 0 else k  # that of the last cell is most likely near this one
            other = occupied[which]
            gap_x = max(abs(x - other // CELLS // CELLS) - 1, 0) * side
            gap_y = max(abs(y - other // CELLS % CELLS) - 1, 0) * side
            gap_z = max(abs(z - other % CELLS) - 1, 0) * side
            if gap_x * gap_x + gap_y * gap_y + gap_z * gap_z >= least:
                continue
            for p in range(first[other], first[other + 1]):
                dx = max(x * side - points[p, 0], points[p, 0] - (x + 1) * side, 0.0)
                dy = max(y * side - points[p, 1], points[p, 1] - (y + 1) * side, 0.0)
                dz = max(z * side - points[p, 2], points[p, 2] - (z + 1) * side, 0.0)
                square = dx * dx + dy * dy + dz * dz
                if square < least:
                    least, nearest = square, which
        near[cell] = min(255, int(np.sqrt(least) * (1 - 1e-6) / CODE))


@compiled
def _close_joints(
    joints_a, start_a, boxes_a, centres_a, joints_b, start_b, boxes_b, centres_b,
    limit, same, pairs, distances,
):  # fmt: skip
    count = 0
    for i in range(len(start_a) - 1):
        for j in range(i + 1 if same else 0, len(start_b) - 1):
            bound = 0.0
            for k in range(3):
                c, d = centres_a[i, k], centres_b[j, k]
                e = max(boxes_b[j, 0, k] - c, c - boxes_b[j, 1, k], 0.0)
                f = max(boxes_a[i, 0, k] - d, d - boxes_a[i, 1, k], 0.0)
                bound += e * e + f * f
            if bound >= limit * SLACK:
                continue
            forward = _one_way(joints_a, start_a[i], start_a[i + 1],
                             joints_b, start_b[j], start_b[j + 1], limit)  # fmt: skip
            if forward >= limit:
                continue
            backward = _one_way(joints_b, start_b[j], start_b[j + 1],
                            joints_a, start_a[i], start_a[i + 1], limit - forward)  # fmt: skip
            if forward + backward < limit:
                pairs[count, 0], pairs[count, 1] = i, j
                distances[count] = forward + backward
                count += 1
    return count


@compiled
def _one_way(points, first, last, others, other_first, other_last, limit):
    """Return the mean squared distance of points from others, or something from the limit on."""
    number = last - first
    total = 0.0
    for p in range(first, last):
        x, y, z = points[p, 0], points[p, 1], points[p, 2]
        least = np.inf
        for q in range(other_first, other_last):
            dx = np.float64(x) - others[q, 0]
            dy = np.float64(y) - others[q, 1]
            dz = np.float64(z) - others[q, 2]
            least = min(least, dx * dx + dy * dy + dz * dz)
        total += least
        if total / number >= limit * SLACK:
            return np.inf
    return total / number


@compiled
def _close_surfaces(
    points_a, cells_a, first_a, near_a, points_b, cells_b, first_b, near_b, pairs, limit, distances
):
    for c in range(len(pairs)):
        i, j = pairs[c, 0], pairs[c, 1]
        distances[c] = np.inf
        bound = _cell_bound(cells_a[i], near_b[j]) + _cell_bound(cells_b[j], near_a[i])
        if bound >= limit * SLACK:
            continue
        forward = _mean_square(points_a[i], points_b[j], first_b[j], limit)
        if forward >= limit:
            continue
        backward = _mean_square(points_b[j], points_a[i], first_a[i], limit - forward)
        if forward + backward < limit:
            distances[c] = forward + backward


@compiled
def _cell_bound(cells, near):
    total = 0.0
    for k in range(len(cells)):
        total += np.float64(near[cells[k]]) ** 2
    return total * CODE * CODE / len(cells)


@compiled
def _mean_square(points, others, first, limit):
    """Return the mean squared distance of points from others, or infinity from the limit on."""
    total, number = 0.0, len(points)
    for p in range(number):
        total += _least_square(points[p, 0], points[p, 1], points[p, 2], others, first)
        if total / number >= limit * SLACK:
            return np.inf
    return total / number


@compiled
def _nearest_squares(points, others, first, squares):
    for p in range(len(points)):
        squares[p] = _least_square(points[p, 0], points[p, 1], points[p, 2], others, first)


@compiled
def _least_square(px, py, pz, others, first):
    """Search the point's own cell, then shells of cells around it, while they may be nearer."""
    x, y, z = np.float64(px), np.float64(py), np.float64(pz)
    side = 1.0 / CELLS
    own_x = min(max(int(x * CELLS), 0), CELLS - 1)
    own_y = min(max(int(y * CELLS), 0), CELLS - 1)
    own_z = min(max(int(z * CELLS), 0), CELLS - 1)
    least = np.inf
    for shell in range(CELLS):
        if shell > 1 and ((shell - 1) * side) ** 2 >= least:
            break
        for cx in range(max(own_x - shell, 0), min(own_x + shell, CELLS - 1) + 1):
            dx = max(cx * side - x, x - (cx + 1) * side, 0.0)
            if dx * dx >= least:
                continue
            for cy in range(max(own_y - shell, 0), min(own_y + shell, CELLS - 1) + 1):
                dy = max(cy * side - y, y - (cy + 1) * side, 0.0)
                if dx * dx + dy * dy >= least:
                    continue
                inside = abs(cx - own_x) < shell and abs(cy - own_y) < shell
                step = 2 * shell if inside else 1
                for cz in range(own_z - shell, own_z + shell + 1, step):
                    if cz < 0 or cz >= CELLS:
                        continue
                    cell = (cx * CELLS + cy) * CELLS + cz
                    if first[cell] == first[cell + 1]:
                        continue
                    dz = max(cz * side - z, z - (cz + 1) * side, 0.0)
                    if dx * dx + dy * dy + dz * dz >= least:
                        continue
                    for q in range(first[cell], first[cell + 1]):
                        ex, ey, ez = x - others[q, 0], y - others[q, 1], z - others[q, 2]
                        least = min(least, ex * ex + ey * ey + ez * ez)
    return least
