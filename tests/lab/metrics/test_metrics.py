"""Errors of weights, against plain loops and numbers that can be checked by hand."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import cutcell
from cutcell import ParameterError, Rig, Skeleton, TriangleMesh, WeightsError
from cutcell.errors import Cancelled
from cutcell.pose import linear_blend_skinning, rotate_joint
from cutcell_lab.metrics import (
    deformation_error,
    precision_recall,
    unweighted,
    vertex_shares,
    weight_l1,
)
from tests import meshes

NAN = float("nan")


def chain():
    """Make a ball with four joints in a branching chain, far from symmetric."""
    vertices, faces = meshes.ball(1)
    vertices = vertices * [2.0, 1.0, 0.5] + [3.0, -1.0, 0.2]
    joints = np.array([[3.2, -0.5, 0.4], [3.8, -0.4, 0.5], [4.4, -0.6, 0.4], [4.0, -0.3, 0.3]])
    skeleton = Skeleton(joints, [-1, 0, 1, 1], names=("root", "arm", "hand", "thumb"))
    return Rig(TriangleMesh(vertices, faces), skeleton)


def random_weights(rig, seed):
    rng = np.random.default_rng(seed)
    weights = rng.random((len(rig.mesh.vertices), len(rig.skeleton.joints))) ** 4
    return weights / weights.sum(axis=1, keepdims=True)


def split(rig):
    """Give every triangle vertices of its own, as an exporter does along seams."""
    corners = rig.mesh.faces.ravel()
    mesh = TriangleMesh(rig.mesh.vertices[corners], np.arange(len(corners)).reshape(-1, 3))
    return Rig(mesh, rig.skeleton), corners


def slow_deformation_error(rig, ours, theirs, degrees, joints=None):
    """Move the whole mesh for each joint and axis, and compare (paper section 4.3.1)."""
    scale = 100 / np.ptp(rig.mesh.vertices, axis=0).max()
    errors = []
    for joint in np.flatnonzero(rig.skeleton.deform) if joints is None else joints:
        for axis in "xyz":
            pose = rotate_joint(rig.skeleton, joint, axis, degrees)
            apart = linear_blend_skinning(rig.mesh.vertices, ours, pose)
            apart -= linear_blend_skinning(rig.mesh.vertices, theirs, pose)
            errors.append(((scale * apart) ** 2).sum(axis=1))
    return np.array(errors)


# Weights themselves


def test_l1_by_hand():
    computed = [[1, 0, 0], [0.5, 0.5, 0], [0, 0, 1]]
    reference = [[1, 0, 0], [0, 1, 0], [1, 0, 0]]
    assert weight_l1(computed, reference) == pytest.approx((0 + 1 + 2) / 3)
    assert weight_l1(computed, reference, [1, 1, 0]) == pytest.approx(0.5)
    assert weight_l1(computed, computed) == 0


def test_precision_and_recall_by_hand():
    computed = [[0.5, 0.5, 0], [1, 0, 0]]
    reference = [[1, 0, 0], [0, 0.9995, 0.0005]]
    assert precision_recall(computed, reference) == (pytest.approx(1 / 3), pytest.approx(1 / 2))
    assert precision_recall(computed, computed) == (1, 1)


def test_precision_without_any_weight_is_no_number():
    precision, recall = precision_recall(np.zeros((2, 3)), [[1, 0, 0]] * 2)
    assert np.isnan(precision)
    assert recall == 0


def test_the_unweighted_are_counted():
    assert unweighted([[1, 0], [0, 0], [0.5, 0.5], [0, 0]]) == 0.5
    assert unweighted([[1, 0], [0, 0]], [3, 1]) == 0.25


@given(st.integers(0, 1000), st.integers(0, 1000))
@settings(max_examples=20)
def test_l1_is_a_distance(a, b):
    rig = chain()
    first, second, third = (random_weights(rig, seed) for seed in (a, b, 7))
    assert weight_l1(first, second) == weight_l1(second, first)
    assert 0 <= weight_l1(first, second) <= 2
    assert weight_l1(first, second) <= weight_l1(first, third) + weight_l1(third, second) + 1e-12


# Deformation


@pytest.mark.parametrize("degrees", [30, 90])
def test_the_closed_form_equals_moving_the_mesh(degrees):
    rig = chain()
    computed, reference = random_weights(rig, 1), random_weights(rig, 2)
    computed[5] = 0  # stays where it is
    slow = slow_deformation_error(rig, computed, reference, degrees)
    fast = deformation_error(rig, computed, reference, degrees)
    np.testing.assert_allclose(fast.vertex, slow.max(axis=0), rtol=1e-9)
    np.testing.assert_array_equal(fast.joint, slow.argmax(axis=0) // 3)
    assert fast.mean == pytest.approx(slow.max(axis=0).mean())
    np.testing.assert_allclose(fast.turn_mean.ravel(), slow.mean(axis=1), rtol=1e-9)
    np.testing.assert_allclose(fast.turn_largest.ravel(), slow.max(axis=1), rtol=1e-9)


def test_blocks_change_nothing(monkeypatch):
    rig = chain()
    computed, reference = random_weights(rig, 1), random_weights(rig, 2)
    whole = deformation_error(rig, computed, reference)
    monkeypatch.setattr("cutcell_lab.metrics.deformation.BLOCK_NUMBERS", 20)
    parts = deformation_error(rig, computed, reference)
    np.testing.assert_array_equal(whole.vertex, parts.vertex)
    np.testing.assert_allclose(whole.turn_mean, parts.turn_mean)


def test_measuring_can_be_stopped_between_blocks(monkeypatch):
    rig, reports = chain(), []
    computed, reference = random_weights(rig, 1), random_weights(rig, 2)
    monkeypatch.setattr("cutcell_lab.metrics.deformation.BLOCK_NUMBERS", 20)

    def stop(stage, fraction):
        reports.append((stage, fraction))
        if fraction > 0.2:
            raise Cancelled

    with pytest.raises(Cancelled):
        deformation_error(rig, computed, reference, progress=stop)
    assert reports[0] == ("deformation", 0.0)
    assert 0.2 < reports[-1][1] < 0.5


def test_a_bar_by_hand():
    """All weight on the wrong joint: the tip of a 1 m bar swings by its whole chord."""
    vertices = [[0, 0, 0], [1, 0, 0], [0, 0.01, 0]]
    rig = (TriangleMesh(vertices, [[0, 1, 2]]), Skeleton([[0, 0, 0], [0.5, 0, 0]], [-1, 0]))
    right, wrong = np.array([[1, 0], [0, 1], [1, 0]]), np.array([[1, 0], [1, 0], [1, 0]])
    error = deformation_error(rig, wrong, right)
    chord = 50**2 * 2 * (1 - np.cos(np.pi / 6))
    assert error.mean == pytest.approx(chord / 3)
    worst = error.worst(1)[0]
    assert (worst.joint, worst.name, worst.axis) == (1, "joint 1", "y")
    assert worst.largest == pytest.approx(chord)
    assert len(error.worst(9)) == 2  # about x nothing moves, the root moves all alike


def test_only_the_turned_joints_count():
    rig = chain()
    computed, reference = random_weights(rig, 1), random_weights(rig, 2)
    some = deformation_error(rig, computed, reference, joints=[2])
    assert set(some.joint) == {2}
    assert some.mean < deformation_error(rig, computed, reference).mean
    assert not some.turn_mean[[0, 1, 3]].any()


def test_all_joints_are_turned_when_asked():
    """A control that carries no weight turns what hangs on it."""
    rig = chain()
    skeleton = replace(rig.skeleton, deform=np.array([True, False, True, True]))
    rig = replace(rig, skeleton=skeleton)
    kept = np.array([1.0, 0, 1, 1])
    computed, reference = (random_weights(rig, seed) * kept for seed in (1, 2))
    computed, reference = (w / w.sum(axis=1, keepdims=True) for w in (computed, reference))
    for joints, which in (("deform", [0, 2, 3]), ("all", range(4))):
        slow = slow_deformation_error(rig, computed, reference, 30, which)
        result = deformation_error(rig, computed, reference, joints=joints)
        np.testing.assert_allclose(result.vertex, slow.max(axis=0))
        moved = np.flatnonzero(result.turn_mean.max(axis=1) > 1e-9)
        assert moved.tolist() == [j for j in which if j != 0]  # the root moves all alike
    assert deformation_error(rig, computed, reference).mean == pytest.approx(
        deformation_error(rig, computed, reference, joints="deform").mean
    )


def test_units_and_place_do_not_matter():
    rig = chain()
    computed, reference = random_weights(rig, 1), random_weights(rig, 2)
    moved = (
        TriangleMesh(rig.mesh.vertices * 40 + 5, rig.mesh.faces),
        Skeleton(rig.skeleton.joints * 40 + 5, rig.skeleton.parents),
    )
    expected = deformation_error(rig, computed, reference).mean
    assert deformation_error(moved, computed, reference).mean == pytest.approx(expected)


def test_seams_do_not_count_twice():
    rig = chain()
    computed, reference = random_weights(rig, 1), random_weights(rig, 2)
    torn, corners = split(rig)
    expected = deformation_error(rig, computed, reference).mean
    result = deformation_error(torn, computed[corners], reference[corners])
    assert result.mean == pytest.approx(expected)
    by_vertex = deformation_error(torn, computed[corners], reference[corners], count="vertices")
    assert by_vertex.mean != pytest.approx(expected)
    share = vertex_shares(torn.mesh)
    np.testing.assert_allclose(share @ (computed[corners]), computed.mean(axis=0))


def test_vertices_without_face_count_nothing():
    mesh = TriangleMesh([[0, 0, 0], [1, 0, 0], [0, 1, 0], [9, 9, 9]], [[0, 1, 2]])
    for count in ("welded", "vertices"):
        np.testing.assert_allclose(vertex_shares(mesh, count), [1 / 3, 1 / 3, 1 / 3, 0])


# Bad input


@pytest.mark.parametrize(
    ("call", "error", "words"),
    [
        (lambda w: weight_l1(w, w[:-1]), WeightsError, "same vertices"),
        (lambda w: weight_l1(w * 2, w), WeightsError, "predicted weights of vertex 0"),
        (lambda w: weight_l1(w, -w), WeightsError, "reference weights of vertex 0"),
        (lambda w: weight_l1(w * NAN, w), WeightsError, "not finite"),
        (lambda w: weight_l1("none", w), WeightsError, "array of numbers"),
        (lambda w: weight_l1(w[0], w), WeightsError, "expected \\(n, j\\)"),
        (lambda w: weight_l1(w, w, [1, 2]), ParameterError, "shares have the shape"),
        (lambda w: weight_l1(w, w, 0 * w[:, 0]), ParameterError, "not all zero"),
        (lambda w: deformation_error(chain(), w[:, :2] * 0, w[:, :2] * 0), WeightsError, "joints"),
        (lambda w: deformation_error(chain(), w, w, 200), ParameterError, "degrees"),
        (lambda w: deformation_error(chain(), w, w, joints=[4]), ParameterError, "0 to 3"),
        (lambda w: deformation_error(chain(), w, w, joints=[0.5]), ParameterError, "0 to 3"),
        (lambda w: deformation_error(chain(), w, w, count="?"), ParameterError, "count"),
        (lambda w: deformation_error(chain(), w, w, joints="?"), ParameterError, "joints must be"),
    ],
)
def test_what_cannot_be_compared_is_refused(call, error, words):
    with pytest.raises(error, match=words):
        call(random_weights(chain(), 0))


# Real characters


def test_the_artists_weights_have_no_error(rigs):
    for path in rigs[:4]:
        rig = cutcell.load(path)
        share = vertex_shares(rig.mesh)
        assert weight_l1(rig.weights, rig.weights, share) == 0
        assert deformation_error(rig, rig.weights, rig.weights).mean == 0
        bad = cutcell.bind(rig, 16).weights
        slow = slow_deformation_error(rig, bad, rig.weights, 30).max(axis=0)
        assert deformation_error(rig, bad, rig.weights).mean == pytest.approx(share @ slow)
