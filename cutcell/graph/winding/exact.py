"""Generalized winding numbers, exact on any triangles (Jacobson, Kavan & Sorkine 2013).

On a closed mesh the number at a point p is a signed count of crossings: chi(p), over the
triangles that a ray from p meets, +1 where it leaves and -1 where it enters. An open mesh
adds a solid angle for each edge of its boundary chain (the antipodal method of Martens, Trettner &
Bessmeltsev 2026):

    w(p) = chi(p) + 1/(2 pi) sum c atan2(det(a, b, d), |a||b| + a.b + (a.d)|b| + (b.d)|a|)

with a, b the ends of the edge relative to p, d the opposite of the ray's direction, and c the
signed incidence of the edge a -> b. Each term is the solid angle of the triangle that the edge
spans with the point at infinity behind p: together these triangles close the mesh by a surface
that the ray cannot meet.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ...errors import ParameterError
from ...geometry.sorting import sort_by_group
from ...geometry.weld import weld
from ...rig import TriangleMesh
from ...runtime.compiled import compiled, inlined, no_refcount
from ...runtime.threads import in_threads, parts
from ..lattice import Lattice
from ..rays import column_span, edge_height, height_between
from .boundary import find_boundary

MAX_FACE_CELLS = 16
"""Cells of the grid that a face is listed in, on average: those of a fan cover most of it."""
INFINITESIMAL = 1e-150
"""Smaller than any distance, yet its product with one does not underflow."""
TERMS_RESCALED_BELOW = 1e-100
"""Products are rescaled below this, and above its inverse, before they under- or overflow."""


def winding_number(mesh: TriangleMesh, points: ArrayLike) -> NDArray[np.float64]:
    """Compute the generalized winding number of a mesh at points, exactly.

    It is 1 inside a closed mesh whose faces look outward, 0 outside, and between the two where
    the mesh is open. On the surface itself the number of either side may be returned.

    Parameters
    ----------
    mesh : TriangleMesh
        Closed or open, with any number of components; equal vertices are welded first.
    points : array_like, shape (q, 3)
        In the mesh's units.

    Returns
    -------
    array, shape (q,), float64

    Raises
    ------
    ParameterError
        `points` is not an array of finite numbers of that shape.

    References
    ----------
    Paper section 3.1. Jacobson, Kavan & Sorkine-Hornung, "Robust inside-outside
    segmentation using generalized winding numbers", 2013.
    """
    points = np.asarray(points, np.float64)
    if points.ndim != 2 or points.shape[1] != 3:
        raise ParameterError(f"points must have the shape (q, 3), not {points.shape}")
    if not np.isfinite(points).all():
        raise ParameterError("points must be finite numbers")
    lattice = Lattice.around(mesh, 2)
    vertices, index = weld(lattice.to_unit(mesh.vertices))
    return WindingNumbers(vertices, index[mesh.faces]).at(lattice.to_unit(points))


class WindingNumbers:
    """A welded mesh in the unit cube, prepared for many calls of `at`.

    Parameters
    ----------
    vertices : array, shape (n, 3), float64
    faces : array, shape (m, 3), int32
    """

    def __init__(self, vertices: NDArray[np.float64], faces: NDArray[np.int32]) -> None:
        self._mesh, self._boundary = (vertices, faces), find_boundary(faces)
        self._bins = _bin_faces(vertices, faces)

    def at(self, points: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return the winding number at points (q, 3) of the unit cube, shape (q,)."""

        def number_at(part: slice) -> NDArray[np.float64]:
            ahead = _crossings_ahead(points[part], *self._mesh, *self._bins)
            return ahead + boundary_angles(self._mesh[0], self._boundary, points[part])

        return np.concatenate([np.empty(0), *in_threads(number_at, parts(len(points)))])


def _bin_faces(vertices, faces):
    """List for each cell of a grid over (x, y) the faces whose projection may touch it."""
    cells = int(np.clip(np.sqrt(len(faces)), 1, 512))
    corners = vertices[faces][:, :, :2]
    extent = np.stack([corners.min(axis=1), corners.max(axis=1)])
    while True:
        low, high = np.clip((extent * cells).astype(np.int64), 0, cells - 1)
        size = high - low + 1
        count = size.prod(axis=1)
        if count.sum() <= MAX_FACE_CELLS * len(faces):
            break
        cells //= 2  # a cell is then listed with as many of the faces that cover many
    face = np.repeat(np.arange(len(faces), dtype=np.int32), count)
    k = np.arange(len(face)) - np.repeat(np.cumsum(count) - count, count)
    cell = (low[face, 0] + k // size[face, 1]) * cells + low[face, 1] + k % size[face, 1]
    start, order = sort_by_group(cell, cells**2)
    return cells, start, face[order]


@compiled
def _crossings_ahead(points, vertices, faces, cells, start, listed):
    ahead = np.zeros(len(points))
    for q in range(len(points)):
        pu, pv, height = points[q, 0], points[q, 1], points[q, 2]
        if 0 <= pu <= 1 and 0 <= pv <= 1:
            cell = min(int(pu * cells), cells - 1) * cells + min(int(pv * cells), cells - 1)
            for k in range(start[cell], start[cell + 1]):
                low_v, low_a, high_v, high_a, side = column_span(vertices, faces, listed[k], pu)
                if not low_v <= pv < high_v:
                    continue
                if height_between(low_v, low_a, high_v, high_a, pv) > height:
                    ahead[q] += side
    return ahead


@compiled
def boundary_angles(vertices, boundary, points):
    """Return the winding numbers at points (q, 3) less the crossings ahead, shape (q,)."""
    angles = np.empty(len(points))
    for q in range(len(points)):
        angles[q] = _boundary_angle(vertices, boundary, points[q, 0], points[q, 1], points[q, 2])
    return angles


@no_refcount
def _boundary_angle(vertices, boundary, pu, pv, height):
    """Sum the solid angles of the boundary edges over 4 pi: the winding number less chi.

    The ray runs from (pu, pv, height) along the third coordinate of the vertices.
    """
    loop, start = boundary
    # Each solid angle is twice the argument of a complex number. The arguments are added by
    # multiplying the numbers (x, y); full turns are counted separately: the sum of two
    # arguments in one half plane has wrapped around if the product is in the other.
    x, y, turns = 1.0, 0.0, 0.0
    for k in range(len(start) - 1):
        b = loop[start[k + 1] - 1]
        bu, bv, less_b = _relative(vertices, b, pu, pv, height)
        for e in range(start[k], start[k + 1]):
            a, au, av, less_a = b, bu, bv, less_b
            b = loop[e]
            bu, bv, less_b = _relative(vertices, b, pu, pv, height)
            # The real part as (|a| + a.d)(|b| + b.d) + au bu + av bv: unlike the four terms of
            # the formula, it does not cancel near the ray.
            real = less_a * less_b + au * bu + av * bv
            imaginary = av * bu - au * bv
            if real < 0:
                # The edge lies ahead: where the ray runs into it, the angle jumps by a turn. It
                # must do so exactly where chi does.
                side = _side(vertices, a, b, pu, pv, imaginary)
                if imaginary == 0:
                    turns += side / 2
                    continue
                imaginary = abs(imaginary) * side
            size = abs(real) + abs(imaginary)
            if size == 0:
                continue  # the point lies on the edge
            if size < TERMS_RESCALED_BELOW:
                real, imaginary = real / size, imaginary / size
            was, y = y, x * imaginary + y * real + 0.0  # never -0.0
            x = x * real - was * imaginary
            if was >= 0 and imaginary >= 0 and y < 0:
                turns += 1
            elif was < 0 and imaginary < 0 and y >= 0:
                turns -= 1
            size = abs(x) + abs(y)
            if size < TERMS_RESCALED_BELOW or size > 1 / TERMS_RESCALED_BELOW:
                x, y = x / size, y / size
    return turns + np.arctan2(y, x) / (2 * np.pi)


@inlined
def _relative(vertices, a, pu, pv, height):
    """Return u and v of a vertex relative to the ray's start, and |a| + a.d."""
    u, v, w = vertices[a, 0] - pu, vertices[a, 1] - pv, vertices[a, 2] - height
    # Symbolic perturbation: a ray through a vertex passes it at an infinitesimal distance.
    if u == 0 and v == 0:
        v = -INFINITESIMAL
    squared = u * u + v * v
    length = np.sqrt(squared + w * w)
    return u, v, squared / (length + w) if w > 0 else length - w


@compiled
def _side(vertices, a, b, pu, pv, imaginary):
    """Return on which side of the edge a -> b the ray passes: +1 right, -1 left."""
    a_left = vertices[a, 0] <= pu
    if a_left != (vertices[b, 0] <= pu):
        left, right = (a, b) if a_left else (b, a)
        above = edge_height(vertices, left, right, pu)[0] > pv
        return 1.0 if above == a_left else -1.0
    if imaginary != 0:
        return np.sign(imaginary)
    if vertices[a, 0] != vertices[b, 0]:
        return np.sign(vertices[a, 0] - vertices[b, 0])
    return np.sign(vertices[b, 1] - vertices[a, 1])
