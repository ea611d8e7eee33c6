"""All hits of axis-aligned rays on a mesh (paper section 3.1, algorithm 1).

Casting all rays of an axis amounts to rasterising the triangles seen along it: for each triangle,
visit the lattice columns inside its projection. A column line u = const meets two edges of the
triangle or none, and the ray at height v hits the triangle if v lies between these two. The height
of an edge on a column line is always computed from its left end, so the two triangles that share
the edge get the same number to the last bit. Whatever rounding does, a ray therefore leaves a
closed surface as often as it enters it.

Rays exactly through an edge or a vertex are treated by symbolic perturbation: the ray is moved by
infinitesimal amounts, far less along u than along v. A vertex on the column line is taken as left
of it, and an edge at exactly the ray's height as below it. In all three families of rays u comes
before v in the order x, y, z, so they are perturbed consistently.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..geometry.vectors import triangle_normal
from ..runtime.compiled import inlined, no_refcount
from ..runtime.progress import Tell
from ..runtime.threads import in_threads

AXES = ((1, 2, 0), (0, 2, 1), (0, 1, 2))
"""For rays along x, y, z: the axes (u, v) of the plane across them, and their own axis."""

CONTACT_DISTANCE = 1e-9
"""Distance of two faces that touch, at most: above rounding."""
MANY_HITS = 64
"""Rays with more hits are sorted by numpy."""
FIRST_HITS = 2**14
"""Hits for which memory is taken at first; it is doubled when needed."""


@dataclass(frozen=True, eq=False)
class RayHits:
    """Hits of the R x R rays along one axis on the triangles, ray by ray.

    Parameters
    ----------
    start : array, shape (R * R + 1,), int64
        Hits of ray i * R + j, through u = (i + 1/2) / R and v = (j + 1/2) / R, are
        those from start[i * R + j] to start[i * R + j + 1].
    position : array, shape (c,), float64
        Coordinate along the axis, ascending within each ray.
    triangle : array, shape (c,), int32
    sign : array, shape (c,), int8
        +1 where the ray leaves through the back of the triangle, along its normal; -1 where it
        enters. At equal positions, entering comes first.
    """

    start: NDArray[np.int64]
    position: NDArray[np.float64]
    triangle: NDArray[np.int32]
    sign: NDArray[np.int8]


def cast_rays(
    vertices: NDArray[np.float64], faces: NDArray[np.int32], resolution: int, axis: int
) -> RayHits:
    """Cast the R x R rays along one axis through the lattice points of the unit cube.

    Shapes: vertices (n, 3), faces (m, 3).
    """
    projected = np.ascontiguousarray(vertices[:, AXES[axis]])
    flip = -1 if axis == 1 else 1  # x cross z points along -y
    at, hits, size, face = np.empty(FIRST_HITS), np.empty((FIRST_HITS, 3), np.int32), 0, 0
    while True:
        face, size = _rasterise(projected, faces, resolution, flip, face, size, at, hits)
        if face == len(faces):
            break
        at, hits = (np.concatenate([buffer, np.empty_like(buffer)]) for buffer in (at, hits))
    at, hits = at[:size], hits[:size]
    start = np.append(0, np.cumsum(np.bincount(hits[:, 0], minlength=resolution**2)))
    by_ray = np.empty(size), np.empty(size, np.int32), np.empty(size, np.int8)
    _sort_by_ray(at, hits, start, start[:-1].copy(), *by_ray)
    position, triangle, sign = by_ray
    many = np.repeat(np.diff(start) > MANY_HITS, np.diff(start))
    if many.any():
        ray = np.repeat(np.arange(resolution**2), np.diff(start))[many]
        order = np.lexsort((triangle[many], sign[many], position[many], ray))
        for column in by_ray:
            column[many] = column[many][order]
    return RayHits(start, position, triangle, sign)


def cast_all_rays(
    vertices: NDArray[np.float64],
    faces: NDArray[np.int32],
    resolution: int,
    report: Tell = lambda done: None,
) -> list[RayHits]:
    """Cast the rays along x, y and z, see `cast_rays` and `progress.Tell`."""
    return in_threads(lambda axis: cast_rays(vertices, faces, resolution, axis), range(3), report)


def part_at_contacts(hits: RayHits, part: NDArray[np.int32]) -> RayHits:
    """Leave one closed part before the next is entered, where two touch.

    Shapes: part (m,), of each face, or -1.
    """
    ray = np.repeat(np.arange(len(hits.start) - 1), np.diff(hits.start))
    of, sign, triangle = part[hits.triangle], hits.sign.copy(), hits.triangle.copy()
    is_contact = (
        (np.diff(hits.position) <= CONTACT_DISTANCE) & (ray[1:] == ray[:-1]) & (np.diff(sign) > 0)
    )
    is_contact &= (of[1:] != of[:-1]) & (of[1:] >= 0) & (of[:-1] >= 0)
    k = np.flatnonzero(is_contact)
    for column in (sign, triangle):
        column[k], column[k + 1] = column[k + 1], column[k]
    return RayHits(hits.start, hits.position, triangle, sign)


def expected_hits(
    vertices: NDArray[np.float64], faces: NDArray[np.int32], resolution: int
) -> float:
    """Estimate how many hits the rays along x, y and z have: R^2 times projected areas."""
    return resolution**2 * _projected_area(vertices, faces)


def points_on_rays(
    ray: NDArray[np.integer],
    position: NDArray[np.float64] | np.float64,
    resolution: int,
    axis: int,
) -> NDArray[np.float64]:
    """Return the points at positions (q,) along rays (q,) of one axis, shape (q, 3)."""
    u, v, along = AXES[axis]
    points = np.empty((len(ray), 3))
    points[:, u] = (ray // resolution + 0.5) / resolution
    points[:, v] = (ray % resolution + 0.5) / resolution
    points[:, along] = position
    return points


@inlined
def in_space(axis, u, v, along):
    """Permute coordinates (u, v, along) of the rays along an axis to (x, y, z)."""
    if axis == 0:
        return along, u, v
    if axis == 1:
        return u, along, v
    return u, v, along


@no_refcount
def _rasterise(vertices, faces, resolution, flip, face, size, at, hits):
    """Append the hits of all faces from one on, in any order: position; ray, face and sign.

    Returns the face whose hits no longer fit, or the number of faces, and the number of hits.
    """
    for f in range(face, len(faces)):
        before = size
        u0, u1, u2 = vertices[faces[f, 0], 0], vertices[faces[f, 1], 0], vertices[faces[f, 2], 0]
        end = min(resolution, first_at_least(max(u0, u1, u2), resolution))
        for i in range(first_at_least(min(u0, u1, u2), resolution), end):
            pu = (i + 0.5) / resolution
            low_v, low_a, high_v, high_a, side = column_span(vertices, faces, f, pu)
            j = first_at_least(low_v, resolution)
            while j < resolution and (j + 0.5) / resolution < high_v:
                if size == len(at):
                    return f, before
                at[size] = height_between(low_v, low_a, high_v, high_a, (j + 0.5) / resolution)
                hits[size, 0] = i * resolution + j
                hits[size, 1], hits[size, 2] = f, flip * side
                size += 1
                j += 1
    return len(faces), size


@no_refcount
def _projected_area(vertices, faces):
    """Sum the areas of all triangles projected along x, along y and along z."""
    total = 0.0
    for f in range(len(faces)):
        a, b, c = vertices[faces[f, 0]], vertices[faces[f, 1]], vertices[faces[f, 2]]
        normal = triangle_normal(a, b, c)
        total += abs(normal[0]) + abs(normal[1]) + abs(normal[2])
    return total / 2


@no_refcount
def _sort_by_ray(at, hits, start, cursor, position, triangle, sign):
    """Sort hits by ray and along it, but for rays with many; `cursor` begins as `start` does."""
    for k in range(len(hits)):
        n = cursor[hits[k, 0]]
        position[n], triangle[n], sign[n] = at[k], hits[k, 1], hits[k, 2]
        cursor[hits[k, 0]] += 1
    for ray in range(len(cursor)):
        begin, end = start[ray], start[ray + 1]
        if end - begin > MANY_HITS:  # an insertion sort would be slow
            continue
        for k in range(begin + 1, end):
            p, t, s = position[k], triangle[k], sign[k]
            while k > begin and _after(position[k - 1], sign[k - 1], triangle[k - 1], p, s, t):
                position[k] = position[k - 1]
                triangle[k] = triangle[k - 1]
                sign[k] = sign[k - 1]
                k -= 1
            position[k], triangle[k], sign[k] = p, t, s


@inlined
def first_at_least(coordinate, resolution):
    """Return the first i >= 0 whose (i + 1/2) / R is not below the coordinate."""
    i = max(0, int(np.ceil(coordinate * resolution - 0.5)))
    while i > 0 and (i - 0.5) / resolution >= coordinate:
        i -= 1
    while (i + 0.5) / resolution < coordinate:
        i += 1
    return i


@no_refcount
def column_span(vertices, faces, f, pu):
    """Intersect the column line u = pu with the triangle f.

    Returns the two ends of the intersection as (v, along), lower v first, and the sign of the
    hits on it: +1 if the triangle is counter-clockwise in the (u, v) plane, so that rays leave
    through it, else -1. If the line misses the triangle, the two ends are equal.
    """
    right_v = left_v = right_a = left_a = 0.0
    for k in range(3):
        a, b = faces[f, k], faces[f, (k + 1) % 3]
        a_left = vertices[a, 0] <= pu
        if a_left == (vertices[b, 0] <= pu):
            continue
        if a_left:
            right_v, right_a = edge_height(vertices, a, b, pu)
        else:
            left_v, left_a = edge_height(vertices, b, a, pu)
    if right_v <= left_v:
        return right_v, right_a, left_v, left_a, 1
    return left_v, left_a, right_v, right_a, -1


@inlined
def edge_height(vertices, a, b, pu):
    """Return v and the third coordinate of an edge at u = pu; a is its left end.

    At the left end itself the result is exact.
    """
    width = vertices[b, 0] - vertices[a, 0]
    step = pu - vertices[a, 0]
    v = vertices[a, 1] + step * (vertices[b, 1] - vertices[a, 1]) / width
    along = vertices[a, 2] + step * (vertices[b, 2] - vertices[a, 2]) / width
    return v, along


@inlined
def height_between(low_v, low_a, high_v, high_a, pv):
    """Interpolate the coordinate along the ray at v = pv between the two ends of a span."""
    along = low_a + (pv - low_v) * (high_a - low_a) / (high_v - low_v)
    return min(max(along, min(low_a, high_a)), max(low_a, high_a))


@inlined
def _after(position0, sign0, triangle0, position1, sign1, triangle1):
    if position0 != position1:
        return position0 > position1
    if sign0 != sign1:
        return sign0 > sign1
    return triangle0 > triangle1
