"""Vertices and joints of a prediction, brought into the reference's order."""

import numpy as np
import pytest

from cutcell import Rig, Skeleton, SkeletonError, TriangleMesh, WeightsError
from cutcell_lab.evaluation.align import align_weights

SQUARE = np.array([[0.0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]])
FACES = np.array([[0, 1, 2], [0, 2, 3]])
WEIGHTS = np.array([[1.0, 0], [0.75, 0.25], [0.25, 0.75], [0, 1]])
JOINTS = np.array([[0.0, 0.5, 0], [1, 0.5, 0]])


def square(vertices=SQUARE, faces=FACES, weights=WEIGHTS, joints=JOINTS, names=("a", "b"), **more):
    skeleton = Skeleton(joints, np.arange(len(joints)) - 1, names)
    return Rig(TriangleMesh(vertices, faces), skeleton, weights=weights, **more)


def test_equal_rigs_need_no_matching():
    weights, notes = align_weights(square(), square())
    np.testing.assert_array_equal(weights, WEIGHTS)
    assert notes == []


def test_vertices_in_another_order_and_split_are_matched_by_position():
    order = np.array([2, 0, 3, 1])
    turned = square(SQUARE[order], np.argsort(order)[FACES], WEIGHTS[order])
    split = square(SQUARE[FACES.ravel()], np.arange(6).reshape(2, 3), WEIGHTS[FACES.ravel()])
    for predicted in (turned, split):
        weights, notes = align_weights(predicted, square())
        np.testing.assert_allclose(weights, WEIGHTS)
        assert "vertices matched by position" in notes[0]
    weights, _ = align_weights(square(), split)
    np.testing.assert_allclose(weights, WEIGHTS[FACES.ravel()])


def test_split_vertices_that_differ_are_averaged():
    corners = FACES.ravel()  # 0, 1, 2, 0, 2, 3
    weights = WEIGHTS[corners].copy()
    weights[3] = [0, 1]
    split = square(SQUARE[corners], np.arange(6).reshape(2, 3), weights)
    np.testing.assert_allclose(align_weights(split, square())[0][0], [0.5, 0.5])


def test_another_mesh_is_refused():
    more = np.vstack([SQUARE, [[0.5, 0.9, 0]]])
    faces = np.vstack([FACES, [[3, 2, 4]]])
    larger = square(more, faces, np.vstack([WEIGHTS, [[1, 0]]]))
    with pytest.raises(WeightsError, match="1 of 5 of the prediction lie on none"):
        align_weights(larger, square())
    with pytest.raises(WeightsError, match="1 of 5 of the reference lie on none"):
        align_weights(square(), larger)
    upright = [0, 2, 1]
    with pytest.raises(WeightsError, match="with the same axis up"):
        align_weights(square(SQUARE[:, upright], joints=JOINTS[:, upright]), square())


def test_units_origin_and_axes_of_the_file_do_not_matter():
    names = ("x", "y")  # joints match by position as well
    large = square(100 * SQUARE + 5, joints=100 * JOINTS + 5, names=names)
    upright = [0, 2, 1]
    world = np.eye(4)[[*upright, 3]]
    turned = square(SQUARE[:, upright], joints=JOINTS[:, upright], names=names, world=world)
    for predicted in (large, turned):
        np.testing.assert_array_equal(align_weights(predicted, square())[0], WEIGHTS)


def test_joints_are_matched_by_name_in_any_order():
    swapped = square(weights=WEIGHTS[:, ::-1], joints=JOINTS[::-1], names=("b", "a"))
    weights, notes = align_weights(swapped, square())
    np.testing.assert_array_equal(weights, WEIGHTS)
    assert notes == []


def test_joints_without_weight_may_lack_or_be_extra():
    three = np.array([*JOINTS, [2, 0.5, 0]])
    empty = np.column_stack([WEIGHTS, np.zeros(4)])
    extra = square(weights=empty, joints=three, names=("a", "b", "end"))
    weights, notes = align_weights(extra, square())
    np.testing.assert_array_equal(weights, WEIGHTS)
    assert notes == []
    weights, notes = align_weights(square(), extra)
    np.testing.assert_array_equal(weights, empty)
    assert notes == []
    weights, notes = align_weights(square(), extra.with_weights(np.full((4, 3), 1 / 3)))
    np.testing.assert_array_equal(weights, empty)
    assert notes == ["it lacks joints that have weight in the reference: end"]


def test_joints_of_other_names_are_matched_by_position():
    swapped = square(weights=WEIGHTS[:, ::-1], joints=JOINTS[::-1], names=("bone_0", "bone_1"))
    weights, notes = align_weights(swapped, square())
    np.testing.assert_array_equal(weights, WEIGHTS)
    assert notes == ["joints matched by position, because their names differ"]


def test_joints_of_the_same_name_are_matched_by_position():
    twins = square(names=("a", "a"), weights=WEIGHTS[:, ::-1], joints=JOINTS[::-1])
    np.testing.assert_array_equal(align_weights(twins, square())[0], WEIGHTS)


def test_of_joints_at_one_position_the_deforming_one_is_meant():
    both = np.array([JOINTS[0], *JOINTS])
    skeleton = Skeleton(both, [-1, 0, 1], ("control", "a", "b"), deform=[False, True, True])
    rig = Rig(
        TriangleMesh(SQUARE, FACES), skeleton, weights=np.column_stack([0 * SQUARE[:, 0], WEIGHTS])
    )
    weights, _ = align_weights(square(names=("x", "y")), rig)
    np.testing.assert_array_equal(weights, rig.weights)
    root = np.array([[3.0, 3, 0], *JOINTS])  # alone at its position: weight on it is only wrong
    skeleton = Skeleton(root, [-1, 0, 1], ("root", "a", "b"), deform=[False, True, True])
    wrong = square(joints=root[[1, 0]], names=("x", "y"))
    weights, _ = align_weights(wrong, Rig(rig.mesh, skeleton, weights=rig.weights))
    np.testing.assert_array_equal(weights, np.column_stack([WEIGHTS[:, ::-1], 0 * WEIGHTS[:, 0]]))


@pytest.mark.parametrize("joints", [[[5.0, 5, 0], [6, 5, 0]], [[0.0, 0.5, 0], [0, 0.5, 0]]])
def test_another_skeleton_is_refused(joints):
    other = square(joints=np.array(joints), names=("x", "y"))
    with pytest.raises(SkeletonError, match="match no joint of the reference"):
        align_weights(other, square())


def test_a_prediction_without_weights_is_refused():
    with pytest.raises(WeightsError, match="has no weights"):
        align_weights(square(weights=None), square())
