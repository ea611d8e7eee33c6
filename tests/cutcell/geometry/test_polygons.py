"""Polygons cut into triangles: inside of the outline, each side once."""

from collections import Counter

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

from cutcell import MeshError
from cutcell.geometry.polygons import MAX_CORNERS, cut_polygons
from cutcell.geometry.triangles import areas, normals


def cut(points):
    """Return the triangles of one polygon whose corners are points; check that it stays closed."""
    count = len(points)
    triangles, owners = cut_polygons(points, np.arange(count), np.array([count]))
    assert len(triangles) == len(owners) == count - 2
    starts, ends = triangles.ravel().tolist(), np.roll(triangles, -1, axis=1).ravel().tolist()
    sides = Counter(zip(starts, ends, strict=True))
    inner = {(a, b) for a, b in sides if sides[b, a]}
    assert set(sides) - inner == {(k, (k + 1) % count) for k in range(count)}
    assert set(sides.values()) == {1}
    return triangles


def outline(*pairs):
    return np.array([(x, y, 0.0) for x, y in pairs])


def area(points):
    moved = points - points.mean(axis=0)
    return np.linalg.norm(np.cross(moved, np.roll(moved, -1, axis=0)).sum(axis=0)) / 2


def check(points):
    """Check that triangles fill a flat polygon, none of them turned over."""
    triangles = points[cut(points)]
    assert_allclose(areas(triangles).sum(), area(points), rtol=1e-9)
    facing = normals(triangles) @ normals(triangles).sum(axis=0)
    assert (facing >= -1e-9 * np.abs(facing).max()).all()


SHAPES = {
    "arrow": outline((0, 0), (2, -1), (0.5, 0), (2, 1)),
    "C": outline((0, 0), (3, 0), (3, 1), (1, 1), (1, 2), (3, 2), (3, 3), (0, 3)),
    "on a line": outline((0, 0), (1, 0), (2, 0), (2, 2), (1, 2), (0, 2), (0, 1)),
    "double": outline((0, 0), (0, 0), (2, 0), (2, 0), (1, 0.5), (0, 2)),
    "keyhole": outline((0, 0), (4, 0), (4, 4), (0, 4), (0, 0),
                       (1, 1), (1, 3), (3, 3), (3, 1), (1, 1)),
    "thin": outline((0, 0), (1, 0), (1, 1e-4), (1e-4, 1e-4), (1e-4, 1), (0, 1)),
}  # fmt: skip


@pytest.mark.parametrize("name", SHAPES)
@pytest.mark.parametrize("way", [1, -1])
def test_no_triangle_leaves_the_outline_wherever_it_begins(name, way):
    turn = np.linalg.qr(np.random.default_rng(1).normal(size=(3, 3)))[0]
    for first in range(len(SHAPES[name])):
        check(np.roll(SHAPES[name][::way], first, axis=0) @ turn + 7)


@pytest.mark.parametrize("count", [5, 9, 40, 200])
@pytest.mark.parametrize("seed", range(5))
def test_stars_of_any_shape(count, seed):
    rng = np.random.default_rng(seed)
    angle = 2 * np.pi * (np.arange(count) + rng.uniform(0, 0.9, count)) / count
    radius = rng.uniform(0.1, 1, count)
    check(outline(*zip(radius * np.cos(angle), radius * np.sin(angle), strict=True)))


def test_a_spiral():
    angle = np.linspace(0, 6 * np.pi, 200)
    sides = [(r + angle) * np.array([np.cos(angle), np.sin(angle)]) for r in (1, 2.5)]
    check(outline(*sides[0].T, *sides[1].T[::-1]))


def test_convex_polygons_are_fans_from_their_first_corner():
    angle = 2 * np.pi * np.arange(7) / 7
    assert_array_equal(
        cut(outline(*zip(np.cos(angle), np.sin(angle), strict=True))),
        [[0, k, k + 1] for k in range(1, 6)],
    )


def test_a_concave_quadrilateral_that_is_not_flat():
    points = SHAPES["arrow"] + [[0, 0, 0.2], [0, 0, -0.1], [0, 0, 0.1], [0, 0, 0]]
    for first in range(4):
        rolled = np.roll(points, first, axis=0)
        triangles = rolled[cut(rolled)]
        middle = normals(rolled[[[0, 1, 2], [0, 2, 3]]]).sum(axis=0)
        assert (normals(triangles) @ middle > 0).all()


@pytest.mark.parametrize(
    "points",
    [np.zeros((6, 3)), np.arange(15.0).reshape(5, 3), outline((0, 0), (1, 1), (1, 0), (0, 1)),
     outline((0, 0), (2, 2), (2, 0), (0, 2), (1, 3)), np.full((5, 3), np.inf)],
)  # fmt: skip
def test_degenerate_polygons_stay_closed(points):
    cut(points)


def test_polygons_keep_their_order_and_those_without_area_are_left_out():
    corners = np.array([0, 1, 2, 3, 0, 1, 2, 1, 0, 3, 2, 1])
    triangles, owners = cut_polygons(SHAPES["arrow"], corners, np.array([4, 3, 2, 0, 3]))
    assert_array_equal(owners, [0, 0, 1, 4])
    assert_array_equal(triangles[2:], [[4, 5, 6], [9, 10, 11]])
    # The diagonal leaves the corner that is concave.
    assert all(2 in one for one in triangles[:2].tolist())


def test_a_comb_with_too_many_corners_is_refused():
    teeth = np.arange(MAX_CORNERS // 2 + 1)
    upper = zip(teeth, 1 + teeth % 2, strict=True)
    points = outline(*upper, *zip(teeth[::-1], -(teeth % 2), strict=True))
    with pytest.raises(MeshError, match="polygon 0 has"):
        cut_polygons(points, np.arange(len(points)), np.array([len(points)]))
