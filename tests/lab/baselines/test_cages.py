"""Cages, and weights carried from them, against closed forms, libigl and numeric integrals."""

import igl
import numpy as np
import pytest
import trimesh
from igl.copyleft import tetgen

import cutcell
from cutcell import Rig, Skeleton, TriangleMesh
from cutcell.isolated import run as apart
from cutcell.isolated.run import WorkFailedError
from cutcell_lab.baselines import METHODS
from cutcell_lab.baselines.body import Body
from cutcell_lab.baselines.cages import cage_methods
from cutcell_lab.baselines.cages.cage_methods import _make, make_cage
from cutcell_lab.baselines.cages.harmonic import harmonic_values
from cutcell_lab.baselines.cages.mean_value import mean_values
from cutcell_lab.isolated import cage as worker
from tests import meshes
from tests.bars import bar, grid_box

pytestmark = pytest.mark.slow

INSIDE = np.random.default_rng(0).uniform(0.15, 0.85, (60, 3))


@pytest.fixture(autouse=True)
def nothing_remembered():
    """Let no test see a cage that another one made."""
    _make.cache_clear()


def crooked_box():
    """Make a unit box of small triangles, and a value that changes at random over its corners."""
    vertices, faces = grid_box(2, 2, 2, (1.0, 1.0, 1.0))
    values = np.random.default_rng(1).random((len(vertices), 2))
    return vertices, faces, values


# The cage itself


@pytest.mark.parametrize("make", [meshes.ball, meshes.torus, meshes.grid_soup, meshes.tube])
def test_a_cage_is_closed_coarse_and_holds_the_mesh(make):
    vertices, faces = make()
    rig = Rig(TriangleMesh(vertices, faces), Skeleton([[0.5, 0.5, 0.5]], [-1]))
    body = Body.of(rig, resolution=32)
    cage, failed, _ = make_cage(body)
    assert failed == ""
    assert len(cage.faces) <= 1600
    solid = trimesh.Trimesh(cage.vertices, cage.faces, process=False)
    assert solid.is_watertight
    assert solid.volume > 0
    assert solid.contains(body.points[np.unique(body.faces)]).all()
    assert abs(solid.bounds - [[0, 0, 0], [1, 1, 1]]).max() < 0.6


def test_a_cage_gets_more_triangles_until_it_holds_all():
    solid = np.zeros((9, 9, 9), bool)
    solid[2:7, 2:7, 2:7] = True
    corners = np.array(np.meshgrid(*[[2.0, 7.0]] * 3)).reshape(3, -1).T
    result = worker.make_cage(solid, corners, 4)
    assert 4 < len(result["faces"]) < 400
    with pytest.raises(RuntimeError, match="holds the whole mesh"):
        worker.make_cage(solid, np.array([[50.0, 0, 0]]), 4)


def test_vertices_of_a_cage_follow_their_nearest_bone():
    rig = bar()
    cage = make_cage(Body.of(rig, resolution=32))[0]
    far = abs(cage.vertices[:, 0] - 0.5) > 0.01
    np.testing.assert_array_equal(cage.joint[far], (cage.vertices[far, 0] > 0.5).astype(int))
    np.testing.assert_array_equal(cage.weights(3).argmax(axis=1), cage.joint)


# Mean value coordinates


@pytest.mark.parametrize("points", [INSIDE, INSIDE + 1.5])
def test_mean_values_carry_linear_functions_exactly(points):
    vertices, faces, _ = crooked_box()
    np.testing.assert_allclose(mean_values(vertices, faces, points, vertices), points, atol=1e-9)
    one = np.ones((len(vertices), 1))
    np.testing.assert_allclose(mean_values(vertices, faces, points, one), 1, atol=1e-12)


def test_mean_values_are_means_over_all_directions():
    """Their definition: what is seen in each direction, by one over its distance."""
    vertices, faces, values = crooked_box()
    count = 40_000
    height = 1 - 2 * (np.arange(count) + 0.5) / count
    turn = np.pi * (1 + np.sqrt(5)) * np.arange(count)
    flat = np.sqrt(1 - height**2)
    ways = np.stack([flat * np.cos(turn), flat * np.sin(turn), height], axis=1)
    cage = trimesh.Trimesh(vertices, faces, process=False)
    for point in INSIDE[:3]:
        hit, ray, face = cage.ray.intersects_location(
            np.tile(point, (count, 1)), ways, multiple_hits=False
        )
        assert len(np.unique(ray)) > 0.999 * count
        near = 1 / np.linalg.norm(hit - point, axis=1)
        share = trimesh.triangles.points_to_barycentric(cage.triangles[face], hit)
        seen = np.einsum("rc,rcj->rj", share, values[faces[face]])
        slow = (near[:, None] * seen).sum(axis=0) / near.sum()
        result = mean_values(vertices, faces, point[None], values)[0]
        np.testing.assert_allclose(result, slow, atol=2e-3)


def test_mean_values_on_the_cage_are_its_own():
    vertices, faces, values = crooked_box()
    np.testing.assert_allclose(mean_values(vertices, faces, vertices, values), values)
    middle = vertices[faces].mean(axis=1)
    result = mean_values(vertices, faces, middle, values)
    np.testing.assert_allclose(result, values[faces].mean(axis=1), atol=1e-9)


# Harmonic coordinates


def test_harmonic_values_carry_linear_functions():
    vertices, faces, _ = crooked_box()
    result = harmonic_values(vertices, faces, INSIDE, vertices, 32)
    np.testing.assert_allclose(result, INSIDE, atol=0.5 / 32)


def test_harmonic_values_equal_libigls_on_tetrahedra():
    vertices, faces, values = crooked_box()
    nodes, tets = tetgen.tetrahedralize(vertices, faces.astype(np.int64), flags="pq1.2a0.0003Q")[:2]
    border = np.flatnonzero(((nodes == 0) | (nodes == 1)).any(axis=1))
    away, face, at = igl.point_mesh_squared_distance(nodes[border], vertices, faces.astype(int))
    assert away.max() < 1e-12
    share = trimesh.triangles.points_to_barycentric(vertices[faces[face]], at)
    held = np.einsum("rc,rcj->rj", share, values[faces[face]])
    expected = igl.harmonic(nodes, tets.astype(np.int64), border, held, 1)
    inner = ((nodes > 0.15) & (nodes < 0.85)).all(axis=1)
    assert inner.sum() > 100
    result = harmonic_values(vertices, faces, nodes[inner], values, 40)
    np.testing.assert_allclose(result, expected[inner], atol=0.03)
    assert values.min() <= result.min()
    assert result.max() <= values.max()


def test_nothing_is_carried_outside_the_cage():
    vertices, faces, values = crooked_box()
    result = harmonic_values(vertices, faces, np.array([[1.5, 0.5, 0.5]]), values, 16)
    assert np.isnan(result).all()


# The methods


@pytest.mark.parametrize("name", ["harmonic", "mean_value"])
def test_a_cage_joins_what_is_near(name):
    """Two bars with a gap of 0.05: a cage of 16 voxels is one around both, one of 128 is not."""
    vertices, faces = grid_box(20)
    beside = np.concatenate([vertices, vertices + np.array([0, 0.25, 0])])
    mesh = TriangleMesh(beside, np.concatenate([faces, faces + len(vertices)]))
    joints = [[0, 0.1, 0.1], [1, 0.1, 0.1], [0, 0.35, 0.1], [1, 0.35, 0.1]]
    skeleton = Skeleton(joints, [-1, 0, -1, 2], deform=[True, False, True, False])
    rig = Rig(mesh, skeleton)
    lower = np.arange(len(beside)) < len(vertices)
    leak = [METHODS[name](rig, cage_resolution=size).weights[lower, 2].mean() for size in (16, 128)]
    assert leak[0] > 0.1
    assert leak[1] < 0.002
    assert cutcell.bind(rig, 16, max_influences=None).weights[lower, 2].max() == 0


@pytest.mark.parametrize("name", ["harmonic", "mean_value"])
def test_a_cage_that_cannot_be_made_says_so(name, monkeypatch):
    monkeypatch.setattr(apart, "COMMAND", ("false",))
    result = METHODS[name](bar(4))
    assert result.weights is None
    assert "libigl's cage stopped with exit code 1" in result.failed
    assert set(result.seconds) == {"cage"}


def test_equations_that_cannot_be_solved_say_so(monkeypatch):
    monkeypatch.setattr("cutcell_lab.baselines.cages.harmonic.cg", lambda a, b, rtol: (b, 1))
    vertices, faces, values = crooked_box()
    with pytest.raises(WorkFailedError, match="could not be solved"):
        harmonic_values(vertices, faces, INSIDE, values, 8)
    result = cage_methods.harmonic(bar(4))
    assert result.failed == "the harmonic equations could not be solved"
    assert set(result.seconds) == {"cage", "weights"}
