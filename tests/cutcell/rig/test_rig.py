"""The data's own doors: each bad array is named in a sentence, and good ones are frozen."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from cutcell import MeshError, Rig, Skeleton, SkeletonError, TriangleMesh, WeightsError
from cutcell.rig import Clip
from cutcell.rig.rig import FAR_OUTSIDE

CORNERS = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], float)
TETRAHEDRON = np.array([[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]])


def mesh() -> TriangleMesh:
    return TriangleMesh(CORNERS, TETRAHEDRON)


def chain(count: int = 2, **kwargs) -> Skeleton:
    joints = np.linspace([0.1, 0.1, 0.1], [0.2, 0.2, 0.2], count)
    return Skeleton(joints, np.arange(count) - 1, **kwargs)


def with_value(array, where, value):
    changed = np.array(array)
    changed[where] = value
    return changed


class TestMesh:
    def test_keeps_what_it_was_given_in_fixed_types(self):
        made = TriangleMesh(CORNERS.tolist(), TETRAHEDRON.tolist())
        assert made.vertices.dtype == np.float64
        assert made.faces.dtype == np.int32
        np.testing.assert_array_equal(made.faces, TETRAHEDRON)

    def test_is_frozen_and_leaves_the_givers_arrays_alone(self):
        vertices = CORNERS.copy()
        made = TriangleMesh(vertices, TETRAHEDRON)
        with pytest.raises(ValueError, match="read-only"):
            made.vertices[0] = 1
        vertices[0] = 7
        assert made.vertices[0, 0] == 0

    def test_bounds_are_those_of_the_faces(self):
        stray = np.vstack([CORNERS, [[9, 9, 9]]])
        np.testing.assert_array_equal(TriangleMesh(stray, TETRAHEDRON).bounds, [[0] * 3, [1] * 3])

    @pytest.mark.parametrize(
        ("vertices", "faces", "sentence"),
        [
            (CORNERS, [], "the mesh has no faces"),
            ([], TETRAHEDRON, "only 0"),
            (with_value(CORNERS, (2, 1), np.nan), TETRAHEDRON, "vertex 2 .* not a finite number"),
            (with_value(CORNERS, (1, 0), np.inf), TETRAHEDRON, "vertex 1 .* 1 of 4"),
            (CORNERS, [[0, 1, 4]], r"face 0 uses the vertices \[0, 1, 4\]"),
            (CORNERS, [[0, 1, 2], [-1, 1, 2]], "face 1 uses .* faces out of range: 1"),
            (np.ones((4, 3)), TETRAHEDRON, "all faces of the mesh lie in one point"),
            (CORNERS[:, :2], TETRAHEDRON, r"vertices has the shape \(4, 2\), expected \(any, 3\)"),
            (CORNERS, [[0, 1, 2, 3]], r"faces has the shape \(1, 4\)"),
            (CORNERS, [[0, 1, 2.5]], "faces must be whole numbers"),
            ([["a", "b", "c"]], TETRAHEDRON, "vertices must be an array of real numbers"),
            (CORNERS + 1j, TETRAHEDRON, "vertices must be an array of real numbers, not of compl"),
            ([[0, 0, 0], [1, 0]], TETRAHEDRON, "vertices must be an array of numbers"),
        ],
    )
    def test_says_what_is_wrong(self, vertices, faces, sentence):
        with pytest.raises(MeshError, match=sentence):
            TriangleMesh(vertices, faces)


class TestSkeleton:
    def test_names_and_deform_have_defaults(self):
        made = chain(2)
        assert made.names == ("joint 0", "joint 1")
        assert made.deform.all()

    def test_a_mesh_without_a_skeleton_has_one_of_no_joints(self):
        none = Skeleton([], [])
        assert none.joints.shape == (0, 3)
        assert none.parents.shape == none.deform.shape == (0,)
        assert none.names == none.children == ()
        assert none.subtree.shape == (0, 0)
        assert Skeleton([], [], orientations=[]).orientations.shape == (0, 3, 3)

    def test_several_roots_are_allowed(self):
        made = Skeleton(np.zeros((3, 3)), [-1, -1, 1])
        assert [c.tolist() for c in made.children] == [[], [2], []]

    @pytest.mark.parametrize(
        ("joints", "parents", "kwargs", "sentence"),
        [
            (np.zeros((2, 3)), [-1], {}, r"parents has the shape \(1,\), expected \(2,\)"),
            (np.zeros((2, 3)), [-1, 0], {"names": ("a",)}, "2 joints but 1 names"),
            (np.zeros((2, 3)), [-1, 0], {"names": "ab"}, "must be a list of them, not 'ab'"),
            (np.zeros((2, 3)), [-1, 0], {"names": 5}, "must be a list of them, not 5"),
            (np.zeros((2, 3)), [-1, 0], {"names": ("a", 5)}, "name of joint 1 must be a text"),
            (np.zeros((2, 3)), [], {}, r"parents has the shape \(0,\), expected \(2,\)"),
            (np.zeros((1, 3)), [-1], {"deform": [np.nan]}, "deform must be True or False each"),
            ([[0, 0, np.nan]], [-1], {"names": ("hip",)}, 'joint "hip" has a coordinate'),
            (np.zeros((2, 3)), [-1, 2], {"names": ("hip", "leg")}, '"leg" has the parent 2'),
            (np.zeros((2, 3)), [-2, 0], {}, '"joint 0" has the parent -2'),
            (np.zeros((2, 3)), [-1, 0.5], {}, "parents must be whole numbers"),
            (np.zeros((1, 3)), [-1], {"deform": [False]}, "no joint .* may carry weight"),
            (np.zeros((1, 3)), [-1], {"deform": [True, True]}, "deform has the shape"),
            (np.zeros((1, 3)), [-1], {"orientations": np.eye(3)}, "orientations has the shape"),
            (np.zeros((1, 3)), [-1], {"orientations": np.full((1, 3, 3), np.inf)}, "orientation"),
            (np.zeros((1, 3)), [0], {"names": ("hip",)}, 'cycle: "hip" -> "hip"'),
            (
                np.zeros((4, 3)),
                [-1, 3, 1, 2],
                {"names": ("root", "a", "b", "c")},
                'cycle: "[abc]" -> "[abc]" -> "[abc]" -> "[abc]"; every joint needs a root',
            ),
        ],
    )
    def test_says_what_is_wrong(self, joints, parents, kwargs, sentence):
        with pytest.raises(SkeletonError, match=sentence):
            Skeleton(joints, parents, **kwargs)

    def test_a_joint_below_a_cycle_is_not_named_as_part_of_it(self):
        with pytest.raises(SkeletonError, match='"a"') as caught:
            Skeleton(np.zeros((3, 3)), [2, 0, 0], names=("a", "below", "b"))
        assert "below" not in str(caught.value)

    @given(st.lists(st.integers(0, 1_000_000), min_size=1, max_size=12))
    def test_subtree_is_what_climbing_up_finds(self, draws):
        parents = [-1] + [d % (i + 1) for i, d in enumerate(draws)]
        skeleton = Skeleton(np.zeros((len(parents), 3)), parents)
        subtree = skeleton.subtree
        np.testing.assert_array_equal(skeleton.depth, subtree.sum(axis=0) - 1)
        for joint in range(len(parents)):
            above = {joint}
            while parents[joint] >= 0:
                joint = parents[joint]
                above.add(joint)
            moved_by = np.flatnonzero(subtree[:, max(above)])
            assert set(moved_by.tolist()) == above


class TestRig:
    def test_takes_a_mesh_and_a_skeleton_alone(self):
        made = Rig(mesh(), chain())
        assert made.weights is None
        assert made.allowed is None

    def test_with_weights_changes_nothing_else(self):
        before = Rig(mesh(), chain(), name="tom")
        after = before.with_weights(np.full((4, 2), 0.5))
        assert before.weights is None
        assert after.mesh is before.mesh
        assert after.name == "tom"
        assert not after.weights.flags.writeable

    def test_weights_are_scaled_to_sum_to_one(self):
        given = np.array([[1.5, 0.5], [0, 0], [1e-300, 0], [1e308, 1e308]])
        made = Rig(mesh(), chain(), given)
        np.testing.assert_allclose(made.weights, [[0.75, 0.25], [0, 0], [1, 0], [0.5, 0.5]])
        np.testing.assert_array_equal(made.weight_sums[:3], [2, 0, 1e-300])
        again = Rig(mesh(), chain(), made.weights)
        assert again.weight_sums is None
        np.testing.assert_array_equal(again.weights, made.weights)

    @pytest.mark.parametrize(
        ("weights", "sentence"),
        [
            (np.ones((4, 3)), r"weights has the shape \(4, 3\), expected \(4, 2\)"),
            (with_value(np.ones((4, 2)), (1, 0), -0.1), "vertex 1 has a weight .* 1 of 4"),
            (with_value(np.ones((4, 2)), (3, 1), np.nan), "vertex 3 has a weight"),
            (with_value(np.ones((4, 2)), (0, 0), np.inf), "vertex 0 has a weight"),
        ],
    )
    def test_says_what_is_wrong_with_weights(self, weights, sentence):
        with pytest.raises(WeightsError, match=sentence):
            Rig(mesh(), chain(), weights)

    def test_allowed_must_fit(self):
        with pytest.raises(WeightsError, match="allowed has the shape"):
            Rig(mesh(), chain(), allowed=np.ones((2, 2), bool))

    def test_a_joint_in_another_unit_is_named(self):
        far = Skeleton([[0, 0, 0], [0, 300, 0]], [-1, 0], names=("hip", "head"))
        with pytest.raises(SkeletonError, match=r'"head" at .0, 300, 0. lies 173 times .* units'):
            Rig(mesh(), far)

    def test_a_far_joint_without_weight_is_no_error(self):
        far = Skeleton([[0, 0, 0], [0, 300, 0]], [-1, 0], deform=[True, False])
        assert Rig(mesh(), far).skeleton is far

    def test_how_far_is_too_far(self):
        edge = 1 + FAR_OUTSIDE * np.sqrt(3)
        Rig(mesh(), Skeleton([[edge - 1e-6, 0.5, 0.5]], [-1]))
        with pytest.raises(SkeletonError, match="10 times"):
            Rig(mesh(), Skeleton([[edge + 1e-6, 0.5, 0.5]], [-1]))


def test_a_clip_without_frames_has_no_length():
    assert Clip("still", np.zeros(0), np.zeros((0, 1, 4, 4))).duration == 0.0
    assert Clip("walk", np.array([0, 1.5]), np.zeros((2, 1, 4, 4))).duration == 1.5
