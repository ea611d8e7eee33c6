"""Smoothing stays on the surface, symmetry is exact, locked joints keep the artist's work."""

import numpy as np
import pytest

import cutcell
from cutcell import (
    CutcellError,
    MeshError,
    ParameterError,
    Rig,
    Skeleton,
    TriangleMesh,
    WeightsError,
)
from cutcell.editing import refine_weights
from cutcell.editing.locks import joint_index, lock_joints
from cutcell.editing.selections import Neighbours
from cutcell.editing.symmetry import find_mirror, mirrored
from tests import meshes
from tests.bars import bar

RNG = np.random.default_rng(7)


def test_weights_of_another_shape_are_refused():
    with pytest.raises(WeightsError, match=r"weights has the shape \(3, 2\), expected"):
        refine_weights(bar(), np.full((3, 2), 0.5), smoothing=1)


def smooth_weights(mesh, weights, passes):
    return Neighbours.of(mesh).smooth(weights, passes)


def strip(count=6):
    """Triangles in a row along x, vertices in pairs; column i has the x coordinate i."""
    x = np.repeat(np.arange(count), 2)
    vertices = np.stack([x, np.tile([0, 1], count), np.zeros(2 * count)], axis=1)
    low = 2 * np.arange(count - 1)
    faces = np.concatenate(
        [np.stack([low, low + 2, low + 1], 1), np.stack([low + 1, low + 2, low + 3], 1)]
    )
    return TriangleMesh(vertices, faces)


def one_hot(labels, joints):
    return np.eye(joints)[labels]


def mirrored_rig(**changes):
    """Return a ball with a left and a right arm joint, and one in the middle."""
    vertices, faces = meshes.ball()
    middle = vertices[:, 0].mean()
    centred = vertices - [middle, 0, 0]
    mesh = TriangleMesh(centred, faces)
    reach = 0.3 * np.ptp(centred[:, 0])
    y, z = centred[:, 1:].mean(axis=0)
    joints = [[0, y, z], [-reach, y, z], [reach, y, z], [0, y + reach, z]]
    skeleton = Skeleton(joints, [-1, 0, 0, 0], ["hip", "arm.R", "arm.L", "head"])
    return Rig(mesh, skeleton, **changes)


def random_weights(rows, joints, kept=4):
    weights = RNG.random((rows, joints))
    weights[weights < np.sort(weights, axis=1)[:, -kept][:, None]] = 0
    return weights / weights.sum(axis=1, keepdims=True)


# Smoothing


def test_a_pass_is_half_the_vertex_and_half_its_neighbours():
    mesh = TriangleMesh([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]])
    found = smooth_weights(mesh, one_hot([0, 1, 1], 2), 1)
    np.testing.assert_allclose(found, [[0.5, 0.5], [0.25, 0.75], [0.25, 0.75]])


def test_smoothing_carries_weight_one_edge_a_pass_and_keeps_sums():
    mesh = strip()
    weights = one_hot((mesh.vertices[:, 0] > 2).astype(int), 2)
    for passes in (1, 2, 3):
        found = smooth_weights(mesh, weights, passes)
        np.testing.assert_allclose(found.sum(axis=1), 1)
        reached = np.unique(mesh.vertices[found[:, 1] > 0, 0])
        assert reached.min() == 3 - passes
    rig = mirrored_rig()
    weights = random_weights(len(rig.mesh.vertices), 4)
    assert refine_weights(rig, weights) is weights


def test_smoothing_crosses_seams_but_no_gaps():
    left, right = strip(3), strip(3)
    seam = np.concatenate([left.vertices, right.vertices + np.array([2, 0, 0])])
    gap = np.concatenate([left.vertices, right.vertices + np.array([2.01, 0, 0])])
    faces = np.concatenate([left.faces, right.faces + len(left.vertices)])
    weights = one_hot(np.repeat([0, 1], 6), 2)
    apart = smooth_weights(TriangleMesh(gap, faces), weights, 9)
    np.testing.assert_allclose(apart, weights, atol=1e-12)
    crossed = smooth_weights(TriangleMesh(seam, faces), weights, 9)
    assert (crossed > 0).all()
    np.testing.assert_array_equal(crossed[4:6], crossed[6:8])


def test_a_vertex_without_edges_keeps_its_weights():
    mesh = TriangleMesh([[0, 0, 0], [1, 0, 0], [0, 1, 0], [5, 5, 5]], [[0, 1, 2]])
    weights = one_hot([0, 0, 1, 1], 2)
    np.testing.assert_array_equal(smooth_weights(mesh, weights, 5)[3], weights[3])


@pytest.mark.parametrize("passes", [1, 4])
def test_some_vertices_are_smoothed_as_in_the_whole_mesh(passes):
    mesh = strip(9)
    weights, some = random_weights(18, 5), np.array([0, 7, 8, 17])
    neighbours = Neighbours.of(mesh)
    whole = neighbours.smooth(weights, passes)
    np.testing.assert_array_equal(neighbours.smooth(weights, passes, some), whole[some])


def test_smoothing_through_the_body_joins_shells_that_are_close():
    mesh = strip(3)
    vertices = np.concatenate([mesh.vertices, mesh.vertices + np.array([0, 0, 0.1])])
    shells = TriangleMesh(vertices, np.concatenate([mesh.faces, mesh.faces + 6]))
    weights = one_hot(np.repeat([0, 1], 6), 2)
    np.testing.assert_allclose(smooth_weights(shells, weights, 3), weights, atol=1e-12)
    assert (Neighbours.of(shells, within=0.15).smooth(weights, 3) > 0).all()


@pytest.mark.parametrize("passes", [-1, 1.5, 1001, "many"])
def test_wrong_number_of_passes(passes):
    with pytest.raises(ParameterError, match="smoothing must be a whole number from 0 to 1,000"):
        refine_weights(mirrored_rig(), random_weights(12, 4), smoothing=passes)


# Symmetry


def test_mirror_is_found():
    rig = mirrored_rig()
    mirror = find_mirror(rig)
    assert mirror.axis == 0
    assert mirror.position == pytest.approx(0, abs=1e-9)
    np.testing.assert_array_equal(mirror.joint, [0, 2, 1, 3])
    partner = rig.mesh.vertices[mirror.vertex[mirror.vertex >= 0]] * [-1, 1, 1]
    np.testing.assert_allclose(partner, rig.mesh.vertices[mirror.vertex >= 0], atol=1e-2)
    assert (mirror.vertex >= 0).mean() > 0.9


@pytest.mark.parametrize("influences", [1, 2, 3, 4])
def test_symmetric_weights_are_mirrored(influences):
    rig = mirrored_rig()
    mirror = find_mirror(rig)
    weights = random_weights(len(rig.mesh.vertices), 4)
    found = refine_weights(rig, weights, symmetric=True, max_influences=influences)
    np.testing.assert_allclose(found.sum(axis=1), 1)
    assert (found > 0).sum(axis=1).max() <= influences
    paired = mirror.vertex >= 0
    other = found[mirror.vertex[paired]][:, mirror.joint]
    off_plane = mirror.vertex[paired] != np.flatnonzero(paired)
    np.testing.assert_allclose(found[paired][off_plane], other[off_plane], atol=1e-12)
    if influences > 1:  # one influence cannot be shared between left and right
        np.testing.assert_allclose(found[paired], other, atol=1e-12)


@pytest.mark.parametrize(("side", "sign"), [("left", 1), ("right", -1)])
def test_one_side_is_taken_for_the_other(side, sign):
    rig = mirrored_rig()
    mirror, points = find_mirror(rig), rig.mesh.vertices
    weights = random_weights(len(points), 4)
    found = mirrored(weights, mirror, points, side)
    taken = sign * points[:, 0] > 1e-9
    np.testing.assert_array_equal(found[taken], weights[taken])
    other = np.flatnonzero((sign * points[:, 0] < -1e-9) & (mirror.vertex >= 0))
    expected = weights[mirror.vertex[other]][:, mirror.joint]
    np.testing.assert_array_equal(found[other], expected)
    some = other[::3]
    np.testing.assert_array_equal(mirrored(weights, mirror, points, side, some), found[some])


def test_joints_at_one_place_are_paired_by_their_branches():
    base = mirrored_rig()
    joints = np.concatenate([base.skeleton.joints, base.skeleton.joints[[2, 1]]])
    skeleton = Skeleton(joints, [-1, 0, 0, 0, 2, 1])
    mirror = find_mirror(Rig(base.mesh, skeleton))
    np.testing.assert_array_equal(mirror.joint, [0, 2, 1, 3, 5, 4])


def test_a_chain_is_not_its_own_mirror_image():
    base = mirrored_rig()
    chain = Skeleton(base.skeleton.joints[[1, 0, 2]], [-1, 0, 1])
    with pytest.raises(MeshError, match="is not mirrored"):
        find_mirror(Rig(base.mesh, chain))


def test_a_lopsided_mesh_is_told():
    rig = mirrored_rig()
    bent = rig.mesh.vertices + 0.1 * RNG.standard_normal(rig.mesh.vertices.shape)
    lopsided = Rig(TriangleMesh(bent, rig.mesh.faces), rig.skeleton, name="crooked")
    with pytest.raises(MeshError, match="crooked is not mirrored across x, y or z: at best"):
        cutcell.bind(lopsided, 8, symmetric=True)


# Locks


def test_locked_joints_keep_the_artists_weights_and_the_rest_is_shared():
    artist = random_weights(40, 5)
    rig = rig_of(artist)
    computed = random_weights(40, 5)
    found = lock_joints(rig, computed, ["b", 3])
    np.testing.assert_allclose(found.sum(axis=1), 1)
    shared = (computed[:, [0, 2, 4]] > 0).any(axis=1)
    assert shared.any()
    np.testing.assert_allclose(found[shared][:, [1, 3]], artist[shared][:, [1, 3]])
    free = computed[shared][:, [0, 2, 4]]
    rest = 1 - artist[shared][:, [1, 3]].sum(axis=1, keepdims=True)
    expected = free / free.sum(axis=1, keepdims=True) * rest
    np.testing.assert_allclose(found[shared][:, [0, 2, 4]], expected, atol=1e-12)


def test_locks_leave_no_vertex_empty():
    rig = rig_of(np.zeros((4, 5)))
    computed = one_hot([0, 1, 1, 2], 5)
    np.testing.assert_array_equal(lock_joints(rig, computed, ["b"]), computed)
    mixed = np.full((4, 5), 0.2)
    np.testing.assert_allclose(lock_joints(rig, mixed, ["b"]), [[0.25, 0, 0.25, 0.25, 0.25]] * 4)
    everything = lock_joints(rig_of(one_hot([1, 1, 1, 1], 5)), computed, range(5))
    np.testing.assert_array_equal(everything, one_hot([1, 1, 1, 1], 5))


def test_the_smallest_weights_share_what_a_lock_leaves():
    tiny = np.array([[1.0, 0, 5e-324, 0, 0]] * 3)
    locked = lock_joints(rig_of(np.full((3, 5), 0.2)), tiny, ["a"])
    np.testing.assert_allclose(locked, [[0.2, 0, 0.8, 0, 0]] * 3)


@pytest.mark.parametrize("influences", [1, 2, 3])
def test_locked_joints_come_first_among_the_influences(influences):
    artist = random_weights(40, 5, kept=2)
    found = lock_joints(rig_of(artist), random_weights(40, 5), ["a", "b"], influences)
    locked = (artist[:, :2] > 0).sum(axis=1)
    has_room = locked < influences
    assert ((found > 0).sum(axis=1) <= np.maximum(influences, locked))[has_room].all()
    np.testing.assert_array_equal(found[~has_room], artist[~has_room])
    np.testing.assert_array_equal(found[:, :2], artist[:, :2])
    np.testing.assert_allclose(found.sum(axis=1), 1)


def test_where_only_locked_joints_were_computed_all_joints_keep_the_files_weights():
    artist = random_weights(40, 5)
    artist[:10] = one_hot([0] * 10, 5)  # wholly a joint that is free
    computed = one_hot([1] * 20 + [3] * 20, 5)
    found = lock_joints(rig_of(artist), computed, ["b", "d"])
    np.testing.assert_array_equal(found, artist)


def rig_of(weights):
    mesh = TriangleMesh(RNG.random((len(weights), 3)), [[0, 1, 2]])
    joints = RNG.random((weights.shape[1], 3))
    return Rig(mesh, Skeleton(joints, [-1, 0, 0, 0, 0], list("abcde")), weights)


def test_unknown_joints_are_told_with_what_sounds_alike():
    skeleton = Skeleton(np.zeros((3, 3)), [-1, 0, 1], ["Hips", "LeftArm", "LeftHand"])
    assert joint_index(skeleton, "LeftArm") == 1
    with pytest.raises(ParameterError, match=r'no joint "LeftArn" .* there is "LeftArm"'):
        joint_index(skeleton, "LeftArn")
    with pytest.raises(
        ParameterError, match="joint must be a whole number from 0 to 2, not 3; or the name of one"
    ):
        joint_index(skeleton, 3)


def test_a_rig_without_weights_has_nothing_to_lock():
    with pytest.raises(WeightsError, match="no weights of its own"):
        cutcell.bind(mirrored_rig(), 8, locked=["head"])


def test_bind_takes_all_three_together():
    plain = mirrored_rig()
    artist = one_hot(np.zeros(len(plain.mesh.vertices), int), 4)
    rig = plain.with_weights(artist)
    found = cutcell.bind(rig, 12, smoothing=2, symmetric=True, locked=["head"]).weights
    np.testing.assert_allclose(found.sum(axis=1), 1)
    assert (found[:, 3] == 0).all()
    assert (cutcell.bind(rig, 12).weights[:, 3] > 0).any()


def test_what_a_file_cannot_store_stays_away():
    rig = mirrored_rig()
    allowed = np.ones((len(rig.mesh.vertices), 4), bool)
    allowed[:, 3] = False
    bounded = Rig(rig.mesh, rig.skeleton, allowed=allowed)
    weights = random_weights(len(allowed), 4)
    weights[:, 3] = 0
    weights /= weights.sum(axis=1, keepdims=True)
    weights[0] = [0, 0, 0, 1]
    found = refine_weights(bounded, weights, smoothing=3)
    assert (found[1:, 3] == 0).all()
    np.testing.assert_allclose(found.sum(axis=1), 1)


@pytest.mark.parametrize(
    ("asked", "sentence"),
    [
        ({"locked": 5}, "locked must be a list of joints, by index or by name, not 5"),
        ({"locked": "hip"}, "locked must be a list of joints, by index or by name, not 'hip'"),
        ({"locked": ["hop"]}, 'there is no joint "hop"'),
        ({"locked": ["hip"]}, "has no weights of its own"),
        ({"locked": {"hip"}}, "locked must be a list of joints"),
        ({"locked": [3j]}, "joint must be a whole number from 0 to 3"),
        ({"smoothing": -1}, "smoothing must be a whole number"),
        ({"symmetric": "no"}, "symmetric must be True or False, not 'no'"),
    ],
)
def test_what_cannot_be_refined_is_refused_before_weights_are_computed(asked, sentence):
    rig = mirrored_rig()
    with pytest.raises(CutcellError, match=sentence):
        cutcell.bind(rig, progress=lambda stage, done: pytest.fail("it has begun"), **asked)
    with pytest.raises(CutcellError, match=sentence):
        refine_weights(rig, random_weights(len(rig.mesh.vertices), 4), **asked)
