"""Embree, Open3D and the fast winding number find what the exact kernels find."""

import sys
from functools import partial

import numpy as np
import pytest

from cutcell import MissingLibraryError, TriangleMesh
from cutcell.geometry.line_hits import AXES
from cutcell.geometry.weld import weld
from cutcell.graph import libraries
from cutcell.graph.rays import cast_all_rays, cast_rays
from cutcell.graph.segments import PointwiseWindingNumbers, inside_intervals
from cutcell.graph.surface import prepare_surface
from cutcell.graph.winding.exact import winding_numbers_of
from tests import meshes

RUN = ("ray", "first", "last", "low", "high")
FLOAT32 = 2e-6
"""Rays within this distance of an edge may miss or double it in float32."""


def open3d_rays(*arguments):
    pytest.importorskip("open3d", reason="Open3D is not installed", exc_type=ImportError)
    return libraries.cast_rays_open3d(*arguments)


CASTERS = {"open3d": open3d_rays, "embree": libraries.cast_rays_embree}


def turned(vertices, faces):
    """Turn a mesh about a skew axis, so that hardly any ray meets an edge."""
    angle = 0.3
    cos, sin = np.cos(angle), np.sin(angle)
    about_z = np.array([[cos, -sin, 0], [sin, cos, 0], [0, 0, 1]])
    about_x = np.array([[1, 0, 0], [0, cos, -sin], [0, sin, cos]])
    points = (vertices - 0.5) @ (about_z @ about_x).T * 0.55 + 0.5
    points, index = weld(points)
    return points, index[faces]


def on_edges(vertices, faces, resolution, axis):
    """Tell which rays pass an edge within float32 rounding."""
    u, v, _ = AXES[axis]
    lattice = (np.arange(resolution) + 0.5) / resolution
    ray = np.stack(np.meshgrid(lattice, lattice, indexing="ij"), -1).reshape(-1, 1, 2)
    plane = vertices[:, [u, v]]
    near = np.zeros(resolution**2, bool)
    for k in range(3):
        a, b = plane[faces[:, k]], plane[faces[:, (k + 1) % 3]]
        along = b - a
        squared = np.maximum((along * along).sum(axis=1), 1e-300)
        travel = np.clip(((ray - a) * along).sum(axis=2) / squared, 0, 1)
        distance = np.linalg.norm(ray - a - travel[..., None] * along, axis=2)
        near |= (distance < FLOAT32).any(axis=1)
    return near


@pytest.mark.parametrize("axis", [0, 1, 2])
@pytest.mark.parametrize("name", ["box", "ball", "torus", "holes", "tube", "flipped"])
@pytest.mark.parametrize("caster", CASTERS)
def test_crossings_equal_the_drawn_ones(caster, name, axis):
    vertices, faces = turned(*meshes.ALL[name]())
    expected = cast_rays(vertices, faces, 24, axis)
    result = CASTERS[caster](vertices, faces, 24, axis)
    assert len(expected.position) > 40
    tied = on_edges(vertices, faces, 24, axis)
    assert tied.mean() < 0.01
    np.testing.assert_array_equal(np.diff(result.start)[~tied], np.diff(expected.start)[~tied])
    clear_found = ~np.repeat(tied, np.diff(result.start))
    clear = ~np.repeat(tied, np.diff(expected.start))
    np.testing.assert_allclose(
        result.position[clear_found], expected.position[clear], atol=1e-5, rtol=0
    )
    # Two crossings nearer than rounding may swap; their triangles and signs swap along.
    apart = np.ones(clear.sum(), bool)
    close = np.flatnonzero(np.diff(expected.position[clear]) < 1e-9)
    apart[close] = apart[close + 1] = False
    for name in ("triangle", "sign"):
        np.testing.assert_array_equal(
            getattr(result, name)[clear_found][apart], getattr(expected, name)[clear][apart]
        )
    assert result.start.dtype == expected.start.dtype
    assert result.triangle.dtype == expected.triangle.dtype
    assert result.sign.dtype == expected.sign.dtype


@pytest.mark.parametrize("caster", CASTERS)
def test_a_ray_through_a_shared_edge_crosses_once(caster):
    # R is a power of two: lattice lines run exactly through the diagonals of the box's sides.
    vertices, faces = meshes.box()
    vertices, index = weld(vertices)
    for axis in range(3):
        result = CASTERS[caster](vertices, index[faces], 16, axis)
        balance = np.concatenate([[0], np.cumsum(result.sign, dtype=int)])[result.start]
        assert (balance == 0).all()
        expected = cast_rays(vertices, index[faces], 16, axis)
        np.testing.assert_array_equal(np.diff(result.start), np.diff(expected.start))


@pytest.mark.parametrize("caster", CASTERS)
def test_doubled_triangles_are_all_found(caster):
    vertices, faces = turned(*meshes.ball(1))
    doubled = np.concatenate([faces, faces[:, ::-1]])
    expected = cast_rays(vertices, doubled, 16, 2)
    result = CASTERS[caster](vertices, doubled, 16, 2)
    np.testing.assert_array_equal(np.diff(result.start), np.diff(expected.start))


def prepared(vertices, faces, resolution):
    """Return the surface of a mesh and its hits; faces stay as they are."""
    surface = prepare_surface(TriangleMesh(vertices, faces), resolution, orient=False)
    return surface, cast_all_rays(surface.mesh.points, surface.mesh.faces, resolution)


def intervals(surface, hits, tau, function):
    """Return the intervals inside by a function of points that returns winding numbers."""
    numbers = PointwiseWindingNumbers(surface, function)
    return inside_intervals(hits, tau, numbers, surface.resolution)


def fast_intervals(surface, hits, tau):
    """Return the intervals inside by libigl's winding numbers."""
    fast = partial(libraries.fast_winding_numbers, surface.mesh.points, surface.mesh.faces)
    return intervals(surface, hits, tau, fast)


def both_runs(mesh, tau):
    """Return the intervals along each axis as sets: by exact winding numbers, and by libigl's."""
    surface, hits = prepared(*mesh, 24)
    exact = partial(winding_numbers_of, surface.mesh)
    plain = intervals(surface, hits, tau, exact)
    pairs = zip(plain, fast_intervals(surface, hits, tau), strict=True)
    return [
        [set(zip(*(getattr(r, n).tolist() for n in RUN), strict=True)) for r in pair]
        for pair in pairs
    ]


@pytest.mark.parametrize("name", ["box", "ball", "torus", "flipped"])
def test_runs_equal_the_exact_ones(name):
    for exact, fast in both_runs(turned(*meshes.ALL[name]()), 0.5):
        assert len(exact) > 20
        assert exact == fast


@pytest.mark.parametrize("name", ["holes", "tube", "open box"])
def test_few_runs_of_open_meshes_differ(name):
    for exact, fast in both_runs(turned(*meshes.ALL[name]()), 0.4):
        assert len(exact) > 20
        assert len(exact ^ fast) <= 0.05 * len(exact)


def test_rays_that_meet_nothing_have_no_runs():
    vertices, faces = meshes.box(0.4, 0.41)
    vertices[:, 2] *= 100  # thin: between the rays along z
    surface, hits = prepared(vertices, faces, 2)
    assert len(hits[2].position) == 0
    assert len(fast_intervals(surface, hits, 0.5)[2].ray) == 0


@pytest.mark.parametrize(
    ("call", "module", "package"),
    [
        (libraries.cast_rays_open3d, "open3d", "pip install open3d"),
        (libraries.cast_rays_embree, "embreex.rtcore_scene", "pip install embreex"),
    ],
)
def test_a_missing_package_is_named(monkeypatch, call, module, package):
    monkeypatch.setitem(sys.modules, module, None)
    with pytest.raises(MissingLibraryError, match=package):
        call(*meshes.box(), 4, 0)


def test_missing_libigl_is_named(monkeypatch):
    surface, hits = prepared(*meshes.box(), 4)
    monkeypatch.setitem(sys.modules, "igl", None)
    with pytest.raises(MissingLibraryError, match="pip install libigl"):
        fast_intervals(surface, hits, 0.5)


@pytest.mark.parametrize(
    ("message", "advice"),
    [
        ("libusb-1.0.so.0: cannot open shared object file", "apt-get install libusb-1.0-0"),
        ("libX.so: cannot open shared object file", "install the library that it names"),
    ],
)
def test_a_missing_system_library_is_named(monkeypatch, message, advice):
    def fail(name):
        raise OSError(message)

    monkeypatch.setattr(libraries, "import_module", fail)
    with pytest.raises(MissingLibraryError, match=advice):
        libraries.cast_rays_open3d(*meshes.box(), 4, 0)
