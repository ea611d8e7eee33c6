"""Transfer of weights to clothes and levels of detail."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial import cKDTree

import cutcell
from cutcell import ParameterError, Rig, Skeleton, SkeletonError, TriangleMesh, WeightsError
from cutcell.editing.transfer import INPAINTED, MATCHED, REFUSED, UNCHANGED, matching
from cutcell.editing.transfer.closest import Surface, barycentric
from cutcell.editing.transfer.inpainting import inpaint
from cutcell.editing.transfer.through import alternatives
from tests.bars import bar, surface_of

GAP = 0.01


@pytest.fixture(autouse=True)
def _coarse(monkeypatch):
    """Build the graphs of these boxes quickly."""
    monkeypatch.setattr(matching, "RESOLUTION", 16)


def limbs(other):
    """Return two limbs that hang side by side, of thickness 0.2 and `other`, joined at the top."""
    x = np.array([0, 0.1, 0.2, 0.2 + GAP, 0.2 + GAP + other / 2, 0.2 + GAP + other])
    y, z = np.linspace(0, 1.2, 21), np.linspace(0, 0.2, 3)
    solid = np.ones((5, 20, 2), bool)
    solid[2, :16] = False
    mesh = surface_of((x, y, z), solid)
    up = np.clip((mesh.vertices[:, 1] - 1) / 0.1, 0, 1)
    first = mesh.vertices[:, 0] < 0.2 + GAP / 2
    joints = [[0.2, 1.1, 0.1], [0.1, 1, 0.1], [0.2 + GAP + other / 2, 1, 0.1]]
    skeleton = Skeleton(joints, [-1, 0, 0], names=["top", "first", "second"])
    return Rig(mesh, skeleton, np.stack([up, (1 - up) * first, (1 - up) * ~first], axis=1))


def sleeve(offset, x=0.0, thickness=0.2, low=0.1, high=0.8):
    """Return a tube around a limb that begins at x, that much away from its skin."""
    sides = x + np.array([-offset, thickness / 2, thickness + offset])
    depth = np.array([-offset, 0.1, 0.2 + offset])
    mesh = surface_of((sides, np.linspace(low, high, 21), depth), np.ones((2, 20, 2), bool))
    height = mesh.vertices[mesh.faces][..., 1]
    faces = mesh.faces[~((height == low).all(axis=1) | (height == high).all(axis=1))]
    used = np.unique(faces)
    return TriangleMesh(mesh.vertices[used], np.searchsorted(used, faces))


def sheet(height=0.25, count=11, width=0.2):
    """Return a flat sheet above a bar."""
    x, z = np.meshgrid(np.linspace(0, 1, count), np.linspace(0, width, 3), indexing="ij")
    points = np.stack([x, 0 * x + height, z], axis=-1).reshape(-1, 3)
    a = (3 * np.arange(count - 1)[:, None] + np.arange(2)).ravel()
    return TriangleMesh(points, np.vstack([np.c_[a, a + 1, a + 4], np.c_[a, a + 4, a + 3]]))


@pytest.fixture(scope="module")
def body():
    rig = bar(20)
    knots = [0.05, 0.5, 0.95]
    columns = [np.interp(rig.mesh.vertices[:, 0], knots, row) for row in np.eye(3)]
    return rig.with_weights(np.stack(columns, axis=1))


def shell(rig, factor=1.1):
    """Return the mesh of a bar, thicker."""
    middle = np.array([0.5, 0.1, 0.1])
    around = (rig.mesh.vertices - middle) * [1, factor, factor] + middle
    return TriangleMesh(around, rig.mesh.faces)


def test_a_mesh_gets_its_own_weights_back(body):
    result = cutcell.transfer(body, body.mesh)
    assert np.abs(result.weights - body.weights).max() < 1e-12
    assert result.report["matched"] == len(body.mesh.vertices)
    assert result.distance.max() < 1e-9


def test_a_shell_follows_the_points_below_it(body):
    result = cutcell.transfer(body, shell(body))
    assert np.abs(result.weights - body.weights).max() < 0.01


@pytest.mark.parametrize("seed", range(3))
def test_closest_points_are_those_of_a_search_of_all_faces(seed):
    rng = np.random.default_rng(seed)
    mesh = TriangleMesh(rng.random((40, 3)) ** 2, rng.integers(0, 40, (60, 3))).welded
    faces, points = mesh.faces[mesh.is_whole], rng.random((50, 3))
    result = Surface(mesh, faces, 0.01).nearest(points)
    share = rng.dirichlet([0.5] * 3, 20_000)
    for point, distance in zip(points, result.distance, strict=True):
        corners = mesh.points[faces]
        every = np.repeat(point[None], len(faces), axis=0)
        closest = np.einsum("fc,fcx->fx", barycentric(every, corners), corners)
        least = np.linalg.norm(closest - point, axis=1).min()
        assert least - 1e-12 <= distance <= least + 0.01 / 2
        sampled = np.linalg.norm(share @ corners[rng.integers(len(faces))] - point, axis=1).min()
        assert least <= sampled + 1e-12


def test_the_vertex_of_a_large_face_among_small_ones_is_closest_to_itself():
    small = sheet(0.0, 400)
    large = np.array([[0.5, 0.001, 0.1], [-3, 4, 0], [4, 4, 0]])
    count = len(small.vertices)
    faces = np.vstack([small.faces, count + np.arange(3)])
    mesh = TriangleMesh(np.vstack([small.vertices, large]), faces).welded
    assert Surface(mesh, mesh.faces, 0.1).nearest(mesh.points).distance.max() < 1e-12


def test_points_on_the_skin_of_one_limb_have_no_match_on_the_other():
    mesh = limbs(0.2).mesh.welded
    surface = Surface(mesh, mesh.faces, 0.02)
    on_skin, beside = mesh.points, mesh.points + np.array([0, 0, 0.01])
    by_limb = np.stack([mesh.points[:, 0], 1 - mesh.points[:, 0]], axis=1)
    for points, others in [(on_skin, False), (beside, True)]:
        closest = surface.nearest(points)
        every = alternatives(surface, points, closest, by_limb, 0.1, 2 * GAP)
        farther = every.distance > closest.distance[every.point] + 1e-9
        assert farther.any() == others


@pytest.mark.parametrize("other", [0.2, 0.5], ids=["legs together", "arm on hip"])
@pytest.mark.parametrize("offset", [0.012, 0.04])
@pytest.mark.parametrize("flipped", [False, True])
def test_a_sleeve_inside_another_limb_follows_its_own(other, offset, flipped):
    rig, tube = limbs(other), sleeve(offset)
    near = cKDTree(rig.mesh.vertices).query(tube.vertices)[1]
    assert rig.weights[near, 2].max() == 1, "the closest vertices alone are wrong"
    result = cutcell.transfer(rig, tube, flipped=flipped)
    assert result.weights[:, 1].min() > 1 - 1e-9
    assert result.resolved.any()


def test_a_sleeve_around_the_other_limb_follows_that_one():
    result = cutcell.transfer(limbs(0.2), sleeve(0.04, x=0.2 + GAP))
    assert result.weights[:, 2].min() > 1 - 1e-9


def test_what_is_far_away_is_inpainted_as_smoothly_as_possible(body):
    """A sheet that only touches at its ends: weights between them are cubic, not constant."""
    mesh = sheet(0.2, 41)
    x = mesh.vertices[:, 0]
    lifted = mesh.vertices + np.where((x > 0.2) & (x < 0.8), 0.3, 0.0)[:, None] * [0, 1, 0]
    result = cutcell.transfer(body, TriangleMesh(lifted, mesh.faces), distance=0.02)
    away = (x > 0.2) & (x < 0.8)
    assert (result.state[away] == INPAINTED).all()
    assert (result.state[~away] == MATCHED).all()
    between = result.weights[:, 0][away]
    assert between.max() <= 1
    assert ((between > 0.02) & (between < 0.98)).any()


def test_inpainting_minimises_the_energy():
    mesh = sheet(count=21).welded
    fixed = (mesh.points[:, 0] < 0.25) | (mesh.points[:, 0] > 0.75)
    first = 0.2 + 0.6 * mesh.points[:, 0]  # linear weights have no energy
    rows = inpaint(mesh, fixed, np.where(fixed[:, None], np.stack([first, 1 - first], 1), 0.0))
    inner = np.abs(rows[:, 0] - first)
    assert inner.max() < 0.02


def test_normals_count_where_fabric_is_not_on_the_skin(body):
    above = sheet(0.24)
    above = TriangleMesh(above.vertices * [0.8, 1, 0.5] + [0.1, 0, 0.05], above.faces)
    turned = TriangleMesh(above.vertices, above.faces[:, ::-1])
    options = {"distance": 0.1, "angle": 30}
    states = {
        name: cutcell.transfer(body, mesh, flipped=flipped, **options).state
        for name, mesh, flipped in (
            ("outward", above, False),
            ("inward", turned, False),
            ("flipped", turned, True),
        )
    }
    assert {len(set(state.tolist())) for state in states.values()} == {1}
    assert sorted(int(state[0]) for state in states.values()) == [MATCHED, MATCHED, REFUSED]
    assert states["flipped"][0] == MATCHED


@pytest.mark.parametrize("turned", [False, True])
def test_most_of_a_component_decides_whether_normals_count_near_the_skin(body, turned):
    """A sheet whose end is folded under it is thick cloth; turned over, it only lies there."""
    flat = sheet(0, 29)
    along = 1.4 * flat.vertices[:, 0]
    under = along > 1
    x = np.where(under, 2 - along, along) * 0.8 + 0.1
    z = 0.5 * flat.vertices[:, 2] + 0.05
    points = np.stack([x, np.where(under, 0.206, 0.21), z], axis=1)
    cloth = TriangleMesh(points, flat.faces[:, ::-1] if turned else flat.faces)
    state = cutcell.transfer(body, cloth).state
    assert (state[under & (x < 0.85)] == MATCHED).all()
    assert (state[along < 0.9] == (INPAINTED if turned else MATCHED)).all()


@pytest.mark.parametrize(
    ("end", "above", "rigid"), [(0.9, 0.02, 1.0), (0.5, 0.02, 0.0), (0.9, 0.001, 0.0)]
)
def test_what_mostly_lies_on_one_joint_follows_it_alone(body, end, above, rigid):
    """A wig on the shoulders; not a sheet over two joints, nor a level of detail."""
    first = np.clip((end + 0.05 - body.mesh.vertices[:, 0]) / 0.05, 0, 1)
    rig = body.with_weights(np.stack([first, 1 - first, 0 * first], axis=1))
    wig = sheet(0.2 + above, 21)
    weights = cutcell.transfer(rig, wig).weights
    others = weights[wig.vertices[:, 0] > 0.96]
    np.testing.assert_allclose(others, np.tile([rigid, 1 - rigid, 0], (len(others), 1)), atol=1e-3)


def test_a_small_part_does_without_the_joints_that_are_far_from_it(body):
    middle = np.array([0.05, 0.2, 0.1])
    button = TriangleMesh((body.mesh.vertices - [0.5, 0.1, 0.1]) * 0.01 + middle, body.mesh.faces)
    result = cutcell.transfer(body, button)
    np.testing.assert_allclose(result.weights, [[1.0, 0, 0]] * len(result.weights), atol=0.02)
    assert result.rig.skeleton.deform.tolist() == [True, False, False]
    assert result.rig.skeleton.names == body.skeleton.names
    with pytest.raises(SkeletonError, match="same units"):
        cutcell.transfer(body, TriangleMesh(button.vertices - [0, 500, 0], button.faces))


def test_a_component_without_match_is_refused_and_still_has_weights(body):
    far = TriangleMesh(body.mesh.vertices + np.array([0, 3, 0]), body.mesh.faces)
    result = cutcell.transfer(body, far)
    assert (result.state == REFUSED).all()
    np.testing.assert_allclose(result.weights.sum(axis=1), 1)


@pytest.mark.parametrize("seed", range(5))
def test_no_row_is_zero(body, seed):
    rng = np.random.default_rng(seed)
    mesh = TriangleMesh(rng.uniform(-0.5, 1.5, (60, 3)), rng.integers(0, 60, (50, 3)))
    weights = body.weights * (rng.random(len(body.weights)) < 0.9)[:, None]
    result = cutcell.transfer(body.with_weights(weights), mesh, max_influences=2)
    np.testing.assert_allclose(result.weights.sum(axis=1), 1)
    assert (result.weights >= 0).all()
    assert ((result.weights > 0).sum(axis=1) <= 2).all()


def test_vertices_at_one_place_get_equal_weights_across_parts_and_targets(body):
    mesh = shell(body)
    apart = TriangleMesh(
        mesh.vertices[mesh.faces].reshape(-1, 3), np.arange(3 * len(mesh.faces)).reshape(-1, 3)
    )
    whole, parts = cutcell.transfer(body, [mesh, apart])
    assert np.array_equal(parts.weights, whole.weights[mesh.faces.ravel()])


def moved(rig, turn, scale, by):
    vertices, joints = (scale * x @ turn.T + by for x in (rig.mesh.vertices, rig.skeleton.joints))
    return replace(
        rig,
        mesh=TriangleMesh(vertices, rig.mesh.faces),
        skeleton=replace(rig.skeleton, joints=joints),
    )


def test_motion_and_scale_change_nothing():
    rig, tube = limbs(0.2), sleeve(0.02)
    expected = cutcell.transfer(rig, tube)
    turn = np.array([[0, -1, 0], [1, 0, 0], [0, 0, 1.0]])
    other = moved(rig, turn, 100.0, [3, 4, 5])
    result = cutcell.transfer(
        other, TriangleMesh(100 * tube.vertices @ turn.T + [3, 4, 5], tube.faces)
    )
    assert np.abs(result.weights - expected.weights).max() < 1e-6
    assert np.array_equal(result.state, expected.state)
    np.testing.assert_allclose(result.distance, 100 * expected.distance, atol=1e-6)


@pytest.mark.parametrize("mirrored", [False, True])
def test_a_rig_lies_where_it_is_in_the_scene(body, mirrored):
    """A file may hold the body in centimetres, with z up, and the clothes as they stand."""
    world = np.eye(4)
    world[:3] = [[100, 0, 0, 5], [0, 0, -100 if mirrored else 100, 6], [0, -100, 0, 7]]
    axes = np.tile(np.eye(3), (len(body.skeleton.joints), 1, 1))
    source = replace(body, world=world, skeleton=replace(body.skeleton, orientations=axes))
    mesh = shell(body)
    faces = mesh.faces[:, ::-1] if mirrored else mesh.faces
    placed = TriangleMesh(mesh.vertices @ world[:3, :3].T + world[:3, 3], faces)
    expected = cutcell.transfer(source, mesh)
    result = cutcell.transfer(source, Rig(placed, Skeleton([], [])))
    np.testing.assert_allclose(result.weights, expected.weights, atol=1e-9)
    np.testing.assert_array_equal(result.state, expected.state)
    np.testing.assert_array_equal(expected.rig.world, world)
    joints = source.skeleton.joints @ world[:3, :3].T + world[:3, 3]
    np.testing.assert_allclose(result.rig.skeleton.joints, joints)
    np.testing.assert_allclose(result.rig.skeleton.orientations, world[:3, :3] / 100 @ axes)


def test_a_skeleton_in_another_pose_does_not_move_its_mesh(body):
    """Clothes with the body's joints, that stand elsewhere in the scene of their file."""
    target, world = dressed(body), np.eye(4)
    world[0, 3] = 0.3
    expected = cutcell.transfer(body, target)
    result = cutcell.transfer(body, replace(target, world=world))
    np.testing.assert_array_equal(result.weights, expected.weights)


@pytest.mark.parametrize("seed", range(3))
def test_the_order_of_vertices_and_faces_changes_nothing(seed):
    rng = np.random.default_rng(seed)
    rig, tube = limbs(0.2), sleeve(0.02)
    expected = cutcell.transfer(rig, tube)

    def shuffled(mesh):
        order = rng.permutation(len(mesh.vertices))
        faces = np.argsort(order)[mesh.faces][rng.permutation(len(mesh.faces))]
        return order, TriangleMesh(mesh.vertices[order], faces)

    order, mesh = shuffled(rig.mesh)
    source = replace(rig, mesh=mesh, weights=rig.weights[order])
    order, mesh = shuffled(tube)
    result = cutcell.transfer(source, mesh)
    assert np.abs(result.weights - expected.weights[order]).max() < 1e-6


def dressed(body):
    """Return a shell that has weights: all of it follows the first joint, and a bit the last."""
    own = np.tile([0.75, 0, 0.25], (len(body.mesh.vertices), 1))
    return replace(body, mesh=shell(body), weights=own, parts=())


def test_named_joints_alone_change(body):
    target = dressed(body)
    result = cutcell.transfer(body, target, joints=["joint 1"])
    every = cutcell.transfer(body, target)
    np.testing.assert_allclose(result.weights[:, 1], every.weights[:, 1], atol=1e-9)
    left = 1 - result.weights[:, 1]
    np.testing.assert_allclose(result.weights[:, 0], 0.75 * left, atol=1e-9)


def test_locked_joints_keep_their_weights(body):
    result = cutcell.transfer(body, dressed(body), locked=["joint 2"])
    np.testing.assert_allclose(result.weights[:, 2], 0.25)
    np.testing.assert_allclose(result.weights.sum(axis=1), 1)


def test_a_mix_and_a_mask_blend_with_the_targets_own_weights(body):
    target, every = dressed(body), cutcell.transfer(body, dressed(body))
    half = cutcell.transfer(body, target, mix=0.5, max_influences=None)
    np.testing.assert_allclose(half.weights, (every.weights + target.weights) / 2, atol=1e-9)
    mask = target.mesh.vertices[:, 0] > 0.5
    masked = cutcell.transfer(body, target, mask=mask)
    assert np.array_equal(masked.weights[~mask], target.weights[~mask])
    np.testing.assert_allclose(masked.weights[mask], every.weights[mask], atol=1e-9)
    assert ((masked.state == UNCHANGED) == ~mask).all()


def test_skeletons_are_matched_by_names_with_exceptions(body):
    names = ["ns:Joint_2", "Joint.0"]
    skeleton = Skeleton(body.skeleton.joints[[2, 0]], [1, -1], names=names)
    target = replace(body, mesh=shell(body), skeleton=skeleton, weights=None, parts=())
    plain = cutcell.transfer(body, shell(body)).weights
    result = cutcell.transfer(body, target).weights  # joint 1 has no partner, joint 0 is above it
    np.testing.assert_allclose(result[:, 1], plain[:, 0] + plain[:, 1], atol=1e-9)
    result = cutcell.transfer(body, target, names={"joint 1": "ns:Joint_2"}).weights
    np.testing.assert_allclose(result[:, 0], plain[:, 1] + plain[:, 2], atol=1e-9)


def test_no_vertex_follows_a_joint_that_its_file_cannot_store(body):
    mesh = shell(body)
    plain, right = cutcell.transfer(body, mesh).weights, mesh.vertices[:, 0] > 0.5
    allowed = np.ones(plain.shape, bool)
    allowed[right, 1] = allowed[~right, 0] = False  # joint 0 is above joint 1, none above joint 0
    target = replace(body, mesh=mesh, weights=None, parts=(), allowed=allowed)
    weights = cutcell.transfer(body, target).weights
    assert plain[right, 1].any()
    assert plain[~right, 0].any()
    assert not weights[~allowed].any()
    moved = (
        np.where(right, plain[:, 0] + plain[:, 1], 0),
        np.where(right, 0, plain[:, 0] + plain[:, 1]),
    )
    np.testing.assert_allclose(weights, np.stack([*moved, plain[:, 2]], axis=1), atol=1e-9)


def test_a_level_of_detail_is_close_to_its_source(body):
    coarse = bar(10).mesh
    at = cKDTree(body.mesh.vertices).query(coarse.vertices)[1]
    result = cutcell.transfer(body, coarse)
    assert np.abs(result.weights - body.weights[at]).max() < 1e-9


def test_wrong_input_is_refused(body):
    with pytest.raises(WeightsError, match="no weights"):
        cutcell.transfer(body.with_weights(None), body.mesh)
    for wrong in (
        {"distance": -1},
        {"angle": 200},
        {"mix": 2},
        {"max_influences": 0},
        {"flipped": 1},
    ):
        with pytest.raises(ParameterError, match=next(iter(wrong))):
            cutcell.transfer(body, body.mesh, **wrong)
    with pytest.raises(ParameterError, match="no target"):
        cutcell.transfer(body, [])
    with pytest.raises(ParameterError, match="one target"):
        cutcell.transfer(body, [body.mesh], mask=np.ones(3))
    with pytest.raises(ParameterError, match="mask"):
        cutcell.transfer(body, body, mask=np.full(len(body.weights), 2.0))
    with pytest.raises(WeightsError, match="own"):
        cutcell.transfer(body, body.mesh, mix=0.5)
    with pytest.raises(ParameterError, match='no joint "elbow"'):
        cutcell.transfer(body, dressed(body), locked=["elbow"])
    other = replace(body, skeleton=Skeleton([[0, 0, 0]], [-1], names=["hip"]), weights=None)
    with pytest.raises(SkeletonError, match="no joint for"):
        cutcell.transfer(body, other)
