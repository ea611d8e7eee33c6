"""Named definitions of errors, against numbers computed by hand."""

import numpy as np
import pytest

import cutcell
from cutcell import ParameterError, Rig, Skeleton, TriangleMesh, WeightsError
from cutcell_lab.metrics import DEFINITIONS, errors_by_definition, pose_error, precision_recall
from tests.bars import bar

SQUARE = [[0.0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]]
FACES = [[0, 1, 2], [0, 2, 3]]
REFERENCE = [[1.0, 0], [0, 1], [0, 1], [1, 0]]
PREDICTED = [[1.0, 0], [0.5, 0.5], [0.0005, 0.9995], [1, 0]]


def two_joints(joints=((0.0, 0, 0), (1, 0, 0)), vertices=SQUARE, faces=FACES):
    skeleton = Skeleton(np.array(joints), [-1, 0], ("root", "tip"))
    return Rig(TriangleMesh(vertices, faces), skeleton)


def test_weights_by_hand():
    errors = errors_by_definition(two_joints(), PREDICTED, REFERENCE)
    assert errors["paper"]["l1"] == pytest.approx((1 + 0.001) / 4)
    assert errors["paper"]["precision"] == pytest.approx(4 / 5)  # 0.0005 is below 0.001 ...
    assert errors["rignet"]["precision"] == pytest.approx(4 / 6)  # ... and above 0.0001
    assert errors["paper"]["recall"] == errors["rignet"]["recall"] == 1
    assert errors["rignet"]["l1"] == pytest.approx((1 + 0.001) / 4)
    assert errors["unirig"]["l1"] == pytest.approx((1 + 0.001) / 8)  # over vertices and joints


def test_deformation_by_hand():
    """A turn of the tip moves a vertex at distance r by 2 (1 - cos 30°) r² times (S - S')²."""
    errors = errors_by_definition(two_joints(), PREDICTED, REFERENCE)
    chord = 2 * (1 - np.cos(np.pi / 6)) * 1e4
    # Vertex 1 is at the tip and does not move. Vertex 2 is 1 away, with a difference of 0.0005.
    assert errors["paper"]["deformation"] == pytest.approx(chord * 0.0005**2 / 4)
    moved = two_joints(joints=((0.0, 0, 0), (1, 1, 0)))  # now it is the other way round
    errors = errors_by_definition(moved, PREDICTED, REFERENCE)
    assert errors["paper"]["deformation"] == pytest.approx(chord * 0.5**2 / 4)


def test_every_joint_turns_in_the_papers_definition():
    """Vertex 2 is farthest from the root, at 3² + 1², which carries no weight itself."""
    skeleton = Skeleton([[-2.0, 0, 0], [0, 0, 0]], [-1, 0], deform=[False, True])
    rig = Rig(TriangleMesh(SQUARE, FACES), skeleton)
    predicted, reference = np.tile([0.0, 1], (4, 1)), np.tile([0.0, 1], (4, 1))
    predicted[2] = 0  # stays where it is
    errors = errors_by_definition(rig, predicted, reference)["paper"]
    chord = 2 * (1 - np.cos(np.pi / 6)) * 1e4
    assert errors["deformation"] == pytest.approx(chord * (3**2 + 1**2) / 4)


def test_equal_weights_have_no_error():
    for definition, errors in errors_by_definition(two_joints(), REFERENCE, REFERENCE).items():
        for measure, value in errors.items():
            assert value == (measure in ("precision", "recall")), (definition, measure)


def test_split_vertices_count_once_in_the_paper_only():
    """Vertices 0 and 2, on the diagonal, are split; vertex 0 has the wrong joint."""
    corners = np.ravel(FACES)
    rig = two_joints(vertices=np.array(SQUARE)[corners], faces=[[0, 1, 2], [3, 4, 5]])
    predicted = np.array([[0.0, 1], [0, 1], [0, 1], [1, 0]])[corners]
    errors = errors_by_definition(rig, predicted, np.array(REFERENCE)[corners])
    assert errors["paper"]["l1"] == pytest.approx(2 / 4)
    assert errors["rignet"]["l1"] == pytest.approx(2 * 2 / 6)
    assert errors["unirig"]["l1"] == pytest.approx(2 * 2 / 12)


def test_poses_are_those_of_linear_blend_skinning():
    rig = bar(6)
    rng = np.random.default_rng(1)
    computed, reference = rng.dirichlet(np.ones(3), (2, len(rig.mesh.vertices)))
    turns = np.random.default_rng(7).uniform(-20, 20, (4, 3, 3))
    distances = []
    for pose in turns:
        lengths = np.linalg.norm(pose, axis=1)
        rotations = [
            cutcell.pose.axis_rotation(vector / length, length)
            for vector, length in zip(pose, lengths, strict=True)
        ]
        transforms = cutcell.forward_kinematics(rig.skeleton, rotations)
        vertices = rig.mesh.vertices
        apart = cutcell.linear_blend_skinning(vertices, computed, transforms)
        apart -= cutcell.linear_blend_skinning(vertices, reference, transforms)
        distances.append(np.linalg.norm(apart, axis=1))  # the longest side is 1
    error = pose_error(rig, computed, reference, poses=4, degrees=20, seed=7)
    assert error.mean == pytest.approx(np.mean(distances))
    assert error.largest == pytest.approx(np.max(distances))
    assert error.mean_square == pytest.approx(np.mean(np.square(distances)))


def test_distances_do_not_depend_on_the_size_of_the_character():
    small, large = two_joints(), two_joints(((0.0, 0, 0), (10, 0, 0)), 10 * np.array(SQUARE))
    a, b = (errors_by_definition(rig, PREDICTED, REFERENCE) for rig in (small, large))
    for name, definition in DEFINITIONS.items():
        for measure in definition.measures:
            assert a[name][measure] == pytest.approx(b[name][measure])


def test_one_pose_by_hand():
    """A square that follows one of two joints in its corner as a whole."""
    skeleton = Skeleton([[0.0, 0, 0], [0, 0, 0]], [-1, -1])
    rig = Rig(TriangleMesh(SQUARE, FACES), skeleton)
    first, second = np.tile([1.0, 0], (4, 1)), np.tile([0.0, 1], (4, 1))
    turn = np.random.default_rng(0).uniform(-30, 30, (1, 2, 3))[0]
    placed = [
        np.array(SQUARE) @ cutcell.pose.axis_rotation(v / np.linalg.norm(v), np.linalg.norm(v)).T
        for v in turn
    ]
    squares = ((placed[0] - placed[1]) ** 2).sum(axis=1)
    error = pose_error(rig, first, second, poses=1)
    assert error.mean_square == pytest.approx(squares.mean())
    # UniRig: coordinates of a mesh twice as large, averaged over x, y and z as well
    loss = errors_by_definition(rig, first, second)["unirig"]["vertex_loss"]
    assert loss == pytest.approx(4 * pose_error(rig, first, second).mean_square / 3)


def test_no_weight_at_all_leaves_nothing_to_divide_by():
    errors = errors_by_definition(two_joints(), np.zeros((4, 2)), REFERENCE)
    assert errors["paper"]["precision"] is None
    assert errors["rignet"]["recall"] == 0


def test_definitions_and_errors_have_the_same_measures():
    errors = errors_by_definition(two_joints(), PREDICTED, REFERENCE)
    assert {name: list(values) for name, values in errors.items()} == {
        name: list(definition.measures) for name, definition in DEFINITIONS.items()
    }


def test_wrong_parameters_are_refused():
    rig = two_joints()
    with pytest.raises(ParameterError, match="poses"):
        pose_error(rig, PREDICTED, REFERENCE, poses=0)
    with pytest.raises(ParameterError, match="degrees"):
        pose_error(rig, PREDICTED, REFERENCE, degrees=181)
    with pytest.raises(ParameterError, match="threshold"):
        precision_recall(PREDICTED, REFERENCE, threshold=2)
    with pytest.raises(WeightsError):
        errors_by_definition(rig, PREDICTED[:3], REFERENCE[:3])
