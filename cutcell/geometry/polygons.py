"""Polygons cut into triangles that stay inside the outline."""

import numpy as np
from numpy.typing import NDArray

from ..errors import MeshError

COLLINEAR = 1e-6
"""Sine of an angle below which three points count as lying on a line."""
MAX_FANS = 8
"""Corners of a polygon from which a fan is tried."""
MAX_CORNERS = 10_000
"""Of a polygon that no such fan fills."""


def cut_polygons(
    points: NDArray[np.float64], corners: NDArray[np.integer], counts: NDArray[np.integer]
) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
    """Cut polygons into triangles.

    A polygon becomes a fan from its first corner if that stays inside the outline, else from
    another one, else ears are clipped. Each side is a side of one triangle, so what was closed
    stays closed. Polygons with fewer than three corners are left out.

    Shapes: points (n, 3), corners (k,), counts (p,); returns triangles (m, 3), positions in
    `corners`, and the polygon of each, (m,).

    Raises
    ------
    MeshError
        More corners than `MAX_CORNERS` in a polygon that no fan fills.
    """
    begin = np.cumsum(counts) - counts
    rows, owners = [np.zeros((0, 3), np.intp)], [np.zeros(0, np.intp)]
    for count in np.unique(counts[counts > 2]).tolist():
        polygons = np.flatnonzero(counts == count)
        at = begin[polygons, None] + np.arange(count)
        with np.errstate(over="ignore", invalid="ignore"):  # coordinates that are refused later
            triangles = _cut(points[corners[at]], polygons)
        rows.append(np.take_along_axis(at[:, None], triangles, axis=2).reshape(-1, 3))
        owners.append(np.repeat(polygons, count - 2))
    owner = np.concatenate(owners)
    order = np.argsort(owner, kind="stable")
    return np.concatenate(rows)[order], owner[order]


def _cut(outlines: NDArray, polygons: NDArray) -> NDArray[np.intp]:
    """Return triangles of polygons of k corners, (p, k, 3) and (p,) to (p, k - 2, 3)."""
    count = outlines.shape[1]
    ahead = np.arange(count - 2)
    fan = np.stack([np.zeros_like(ahead), ahead + 1, ahead + 2], axis=1)
    chosen = np.repeat(fan[None], len(outlines), axis=0)
    if count == 3:
        return chosen
    flat = _projected(outlines)
    left = np.arange(len(flat))
    # A quadrilateral has two diagonals: if neither is good, one that covers nothing twice is next.
    tries = [(s, COLLINEAR) for s in range(min(count, MAX_FANS))]
    tries = (
        [(0, COLLINEAR), (1, COLLINEAR), (0, -COLLINEAR), (1, -COLLINEAR)] if count == 4 else tries
    )
    for start, least in tries:
        turned = (fan + start) % count
        fits = (_sines(flat[left][:, turned]) > least).all(axis=1)
        chosen[left[fits]] = turned
        left = left[~fits]
        if not len(left):
            return chosen
    for k in left.tolist() if count > 4 else ():
        if count > MAX_CORNERS:
            raise MeshError(
                f"polygon {polygons[k]} has {count:,} corners and is concave; at most "
                f"{MAX_CORNERS:,} can be cut into triangles. Triangulate it before"
            )
        chosen[k] = _clip_ears(flat[k])
    return chosen


def _projected(outlines: NDArray) -> NDArray:
    """Return polygons in the planes of their area vectors, counter-clockwise, shape (p, k, 2)."""
    moved = outlines - outlines.mean(axis=1, keepdims=True)
    moved = moved / np.maximum(np.abs(moved).max(axis=(1, 2), keepdims=True), 1e-300)
    area = np.cross(moved, np.roll(moved, -1, axis=1)).sum(axis=1)
    normal = area / np.maximum(np.linalg.norm(area, axis=1, keepdims=True), 1e-300)
    # The axis that is most askew to the normal gives the first direction of the plane.
    axis = np.eye(3)[np.abs(normal).argmin(axis=1)]
    first = np.cross(axis, normal)
    first /= np.maximum(np.linalg.norm(first, axis=1, keepdims=True), 1e-300)
    second = np.cross(normal, first)
    return np.einsum("pkc,pdc->pkd", moved, np.stack([first, second], axis=1))


def _cross(a: NDArray, b: NDArray, c: NDArray) -> NDArray:
    """Return twice the signed area of triangles, shapes (..., 2) to (...)."""
    return (b[..., 0] - a[..., 0]) * (c[..., 1] - a[..., 1]) - (b[..., 1] - a[..., 1]) * (
        c[..., 0] - a[..., 0]
    )


def _sines(triangles: NDArray) -> NDArray:
    """Return twice the signed area by the square of the longest side, (..., 3, 2) to (...)."""
    a, b, c = np.moveaxis(triangles, -2, 0)
    longest = np.maximum.reduce([((p - q) ** 2).sum(axis=-1) for p, q in ((a, b), (b, c), (c, a))])
    return _cross(a, b, c) / np.maximum(longest, 1e-300)


def _clip_ears(outline: NDArray) -> NDArray[np.intp]:
    """Return the triangles of one polygon, the best shaped ear first; (k, 2) to (k - 2, 3).

    Where nothing is an ear, since the outline crosses itself, the smallest corner is cut off.
    """
    ring = np.arange(len(outline))
    shape = _sines(outline[np.stack([np.roll(ring, 1), ring, np.roll(ring, -1)], axis=1)])
    ears = np.array([_is_ear(outline, shape, k) for k in ring.tolist()])
    triangles = []
    while len(ring) > 3:
        if not ears.any():
            ears[:] = [_is_ear(outline[ring], shape, k) for k in range(len(ring))]
        if ears.any():
            k = int(np.where(ears, shape, -np.inf).argmax())
        else:
            k = int(np.abs(shape).argmin())
        triangles.append((ring[k - 1], ring[k], ring[(k + 1) % len(ring)]))
        ring, shape, ears = (np.delete(values, k) for values in (ring, shape, ears))
        around = [(k - 1) % len(ring), k % len(ring)]
        for j in around:
            shape[j] = _sines(outline[[ring[j - 1], ring[j], ring[(j + 1) % len(ring)]]])
        for j in around:
            ears[j] = _is_ear(outline[ring], shape, j)
    return np.array([*triangles, tuple(ring)])


def _is_ear(points: NDArray, shape: NDArray, k: int) -> bool:
    """Return whether corner k of a polygon can be cut off, shapes (k, 2) and (k,).

    Only corners that are not convex can be in the way, those on the new side included.
    """
    if not shape[k] > COLLINEAR:
        return False
    a, b, c = points[k - 1], points[k], points[(k + 1) % len(points)]
    others = points[shape <= COLLINEAR]
    inside = np.minimum.reduce([_cross(p, q, others) for p, q in ((a, b), (b, c), (c, a))])
    is_corner = (others[:, None] == np.stack([a, b, c])).all(axis=2).any(axis=1)
    return not ((inside >= -COLLINEAR * _cross(a, b, c)) & ~is_corner).any()
