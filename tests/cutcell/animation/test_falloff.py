"""The falloff for rigs: smooth at joints, rigid between, and near to what artists paint."""

import numpy as np
import pytest
from scipy.sparse import csr_array

import cutcell
from cutcell import Rig, Skeleton, TriangleMesh, bind
from cutcell.animation.falloff import division
from cutcell.animation.falloff.diffusion import SHARPNESS, Diffusion
from cutcell.animation.falloff.division import FACING_LEAST, _facing
from cutcell.animation.falloff.surface_operators import SurfaceOperators
from cutcell.geometry.laplacian import cotangent_laplacian, vertex_areas
from cutcell_lab.baselines.compare import compare
from cutcell_lab.metrics import deformation_error, vertex_shares, weight_l1
from tests import meshes
from tests.bars import grid_box


def limb(thickness=0.2, joints=(0.02, 0.5), count=40):
    vertices, faces = grid_box(count, size=(1.0, thickness, thickness))
    middle = thickness / 2
    skeleton = Skeleton([[x, middle, middle] for x in joints], np.arange(len(joints)) - 1)
    return Rig(TriangleMesh(vertices, faces), skeleton)


def bend(rig):
    """Return x and the first joint's weight along an edge of the bar."""
    weights = bind(rig, 48).weights[:, 0]
    vertices = rig.mesh.vertices
    edge = np.flatnonzero((vertices[:, 1] == 0) & (vertices[:, 2] == 0))
    order = edge[np.argsort(vertices[edge, 0])]
    return vertices[order, 0], weights[order]


def test_a_limb_bends_at_its_joint_and_is_rigid_elsewhere():
    x, first = bend(limb())
    assert (np.diff(first) <= 1e-9).all()
    assert abs(np.interp(0.5, x, first) - 0.5) < 0.05
    assert (first[x < 0.25] > 0.98).all()
    assert (first[x > 0.75] < 0.02).all()


def test_thicker_limbs_bend_over_a_longer_stretch():
    def stretch(thickness):
        x, first = bend(limb(thickness))
        return np.interp(-0.1, -first, x) - np.interp(-0.9, -first, x)

    assert stretch(0.3) > 1.5 * stretch(0.1)


def test_surface_is_given_to_the_bone_that_it_looks_away_from():
    point, start, end = np.zeros(3), np.array([[0, 1.0, -1]]), np.array([[0, 1.0, 1]])
    half = (1 + FACING_LEAST) / 2
    for normal, expected in (([0, -1, 0], 1), ([0, 1, 0], FACING_LEAST), ([1, 0, 0], half)):
        result = _facing(point, np.array(normal, float), start, end, 0, 1)
        assert result == pytest.approx(expected)
    # Of a joint's bones the nearest counts; a vertex on the bone itself looks at nothing.
    both = np.array([[0, 1.0, 0], [0, -2.0, 0]])
    assert _facing(point, np.array([0, 1.0, 0]), both, both, 0, 2) == pytest.approx(FACING_LEAST)
    assert _facing(start[0], np.ones(3), start, end, 0, 1) == pytest.approx(half)


def test_diffusion_is_the_solution_of_its_equation():
    points, faces = meshes.ball(2)
    rng = np.random.default_rng(0)
    weights = rng.random((len(points), 3))
    weights /= weights.sum(axis=1, keepdims=True)
    depth = rng.uniform(0.1, 0.4, len(points))
    screening = SHARPNESS * vertex_areas(points, faces) / depth**2
    system = cotangent_laplacian(points, faces).toarray() + np.diag(screening)
    expected = np.linalg.solve(system, screening[:, None] * weights)
    diffusion = Diffusion.over(SurfaceOperators.over(points, faces), depth, 64)
    result = diffusion.spread(csr_array(weights)).toarray()
    np.testing.assert_allclose(result, expected, atol=1e-12)


def test_a_tiny_face_far_from_all_bones_does_not_make_the_equation_singular():
    points, faces = np.array([[0, 0, 0], [1e-9, 0, 0], [0, 1e-9, 0]]), np.array([[0, 1, 2]])
    surface = SurfaceOperators.over(points, faces.astype(np.int32))
    weights = csr_array(np.eye(2)[[0, 0, 1]])
    spread = Diffusion.over(surface, np.full(3, 1e3), 64).spread(weights)
    np.testing.assert_allclose(spread.toarray(), [[0.75, 0.25]] * 3)


@pytest.mark.parametrize("name", meshes.ALL)
@pytest.mark.parametrize("leaf", ["point", "extend", "fit"])
def test_every_row_is_whole_on_any_mesh(name, leaf):
    joints = [[0.5, 0.5, 0.3], [0.5, 0.5, 0.5], [0.5, 0.52, 0.7], [2, 2, 2]]
    rig = Rig(TriangleMesh(*meshes.ALL[name]()), Skeleton(joints, [-1, 0, 1, -1]))
    weights = bind(rig, 12, leaf=leaf).weights
    assert np.isfinite(weights).all()
    assert (weights >= 0).all()
    np.testing.assert_allclose(weights.sum(axis=1), 1, atol=1e-12)


def test_a_file_gets_only_weights_that_it_can_store():
    rig = limb()
    allowed = np.ones((len(rig.mesh.vertices), 2), bool)
    allowed[rig.mesh.vertices[:, 0] > 0.4, 0] = False
    allowed[0] = [False, True]  # far from all that it may follow
    rig = Rig(rig.mesh, rig.skeleton, allowed=allowed)
    weights = bind(rig, 24).weights
    assert not weights[~allowed].any()
    np.testing.assert_allclose(weights.sum(axis=1), 1, atol=1e-12)


@pytest.mark.parametrize(
    ("name", "most_l1", "most_deformation"),
    [
        ("khronos_CesiumMan", 0.3, 0.5),
        ("khronos_Fox", 0.55, 2.2),
        ("khronos_RiggedFigure", 0.45, 0.9),
        ("quaternius_trex", 0.45, 6.5),
    ],
)
def test_weights_are_near_the_artists(rigs, name, most_l1, most_deformation):
    rig = cutcell.load(next(path for path in rigs if path.stem == name))
    weights = bind(rig).weights
    assert weight_l1(weights, rig.weights, vertex_shares(rig.mesh)) < most_l1
    assert deformation_error(rig, weights, rig.weights).mean < most_deformation


def test_touching_parts_do_not_share_weight(demo_paths):
    """Fingers, arms beside hips, ears on a back."""
    for name in ("biped", "rabbit"):
        rig = cutcell.load(next(path for path in demo_paths if path.stem == name))
        score = compare([rig], ["cutcell_rig"]).rigs[0].scores[0]
        assert score.values["crosstalk"] < 0.02, name
        assert score.values["unweighted"] == 0


def test_weights_end():
    """Of a vertex' joints those with next to nothing get nothing."""
    weights = bind(limb(joints=(0.02, 0.25, 0.5, 0.75)), 48).weights
    held = weights[weights > 0]
    assert held.min() < 0.01  # they end without a step
    assert np.count_nonzero(weights, axis=1).mean() < 2.2
    np.testing.assert_allclose(weights.sum(axis=1), 1)


def test_surface_beyond_the_radius_of_a_bone_is_the_next_ones(monkeypatch):
    """A chin hangs beside the neck, as near to its bone as to the head's."""
    vertices, faces = grid_box(40, 6)
    head = vertices[:, 0] > 0.69
    vertices[head, 1] *= 4
    joints = [[x, 0.1, 0.1] for x in (0.02, 0.4, 0.76, 0.98)]
    skeleton = Skeleton(joints, [-1, 0, 1, 2], deform=[True, True, True, False])
    rig = Rig(TriangleMesh(vertices, faces), skeleton)
    chin = head & (vertices[:, 0] < 0.8) & (vertices[:, 1] > 0.6)
    with_rule = bind(rig, 48).weights[chin, 2]
    monkeypatch.setattr(division, "RADIUS_FACTOR", np.inf)
    assert with_rule.mean() > bind(rig, 48).weights[chin, 2].mean() + 0.1
    assert with_rule.min() > 0.6
