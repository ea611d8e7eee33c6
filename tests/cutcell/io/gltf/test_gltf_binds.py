"""Inverse bind matrices that contradict the nodes of joints without vertices."""

from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

import cutcell
from cutcell.io.gltf.container import read_document
from cutcell.io.gltf.nodes import Nodes
from cutcell.io.gltf.read.accessors import read_accessor
from tests.cutcell.io.gltf.gltf_builder import COLUMN, REST, Builder, moved

QUARTER_X = [np.sqrt(0.5), 0, 0, np.sqrt(0.5)]
TURN_X = np.array([[1, 0, 0, 0], [0, 0, -1, 0], [0, 1, 0, 0], [0, 0, 0, 1.0]])
BAD = {
    "the identity": np.eye(4),
    "times a scale": np.diag([100.0, 100, 100, 1]),
    "mirrored": np.diag([-100.0, -100, -100, 1]),
    "singular": np.diag([1.0, 0, 1, 1]),
    "far away": moved(0, 500, 0),
}
PLACES = np.array([*REST, [0.5, 2, 0.5], [0.5, 2.5, 0.5], [0.9, 2.5, 0.5]])
"""Of root, tip, and of end, beyond and far, which hold nothing."""


def limb(bad=None, matrix=None, parents=(-1, 0, 1, 2, 3), offset=(0, 0, 0), **root):
    """Return a builder with the column and five joints, `bad` of which have another matrix."""
    builder = Builder()
    names = ("root", "tip", "end", "beyond", "far")
    for name, above, place in zip(names, parents, PLACES, strict=True):
        start = PLACES[above] if above >= 0 else np.zeros(3)
        more = root if above < 0 else {}
        builder.node(
            above if above >= 0 else None, name=name, translation=(place - start).tolist(), **more
        )
    inverse = np.array([moved(*-p) @ moved(*-np.array(offset)) for p in PLACES])
    if bad is not None:
        inverse[list(bad)] = matrix
    mesh = builder.mesh(builder.attributes(COLUMN + np.float32(offset)), name="column")
    builder.node(name="body", mesh=mesh, skin=builder.skin(list(range(5)), inverse))
    return builder


@pytest.mark.parametrize("matrix", BAD.values(), ids=BAD)
@pytest.mark.parametrize("bad", [(4,), (2, 3), (2, 3, 4), (3,)])
def test_joints_stand_at_their_nodes_below_the_nearest_good_joint(loaded, matrix, bad):
    rig = loaded(limb(bad, matrix))
    assert_allclose(rig.skeleton.joints, PLACES, atol=1e-6)
    assert_allclose(rig.skeleton.orientations, np.tile(np.eye(3), (5, 1, 1)), atol=1e-6)
    (warning,) = rig.warnings
    assert f'"{rig.skeleton.names[bad[0]]}"' in warning
    assert len(bad) == 1 or warning.startswith(f"{len(bad)} joints")


def test_a_joint_that_holds_vertices_keeps_its_matrix(loaded):
    builder = limb()
    inverse = np.array([moved(*-p) for p in PLACES])
    inverse[1] = np.eye(4)
    builder.json["skins"][0]["inverseBindMatrices"] = builder.accessor(inverse)
    rig = loaded(builder)
    assert_allclose(rig.skeleton.joints[1], 0, atol=1e-6)
    assert not rig.warnings


def test_a_pose_of_the_nodes_moves_no_joint_with_a_matrix_of_its_own(loaded):
    builder = limb()
    for node in (0, 1, 2, 3):
        builder.json["nodes"][node]["rotation"] = QUARTER_X
    builder.json["nodes"][4]["translation"] = [0.2, 0.3, 0]
    rig = loaded(builder)
    assert_allclose(rig.skeleton.joints, PLACES, atol=1e-6)
    assert not rig.warnings


def test_a_bad_joint_of_a_posed_character_stands_as_it_was_bound(loaded):
    builder = limb((2, 3, 4), np.eye(4))
    builder.json["nodes"][1]["rotation"] = QUARTER_X
    assert_allclose(loaded(builder).skeleton.joints, PLACES, atol=1e-6)


def test_a_root_at_the_origin_stays_there(loaded):
    """Also where the character was moved away from it by a pose."""
    builder = limb()
    holder = builder.node(name="base", children=[0])
    builder.json["scenes"][0]["nodes"].remove(0)
    builder.json["nodes"][0]["translation"] = [3, 0, 0]
    builder.json["skins"][0] = {
        "joints": [holder, 0, 1],
        "inverseBindMatrices": builder.accessor(np.array([np.eye(4), *(moved(*-p) for p in REST)])),
    }
    joints = np.zeros((12, 4), "u1")
    joints[:, :2] = 1, 2
    primitive = builder.json["meshes"][0]["primitives"][0]
    primitive["attributes"]["JOINTS_0"] = builder.accessor(joints)
    rig = loaded(builder)
    assert_allclose(rig.skeleton.joints, [[0, 0, 0], *REST], atol=1e-6)
    assert not rig.warnings
    assert_allclose(rig.world, moved(2.5, 0, -0.5), atol=1e-6)


def test_a_joint_of_a_flat_skin_stands_by_where_the_others_say(loaded):
    rig = loaded(limb((2,), np.eye(4), parents=(-1,) * 5, offset=(3, 0, 0)))
    assert_allclose(rig.skeleton.joints, PLACES + np.array([3, 0, 0]), atol=1e-6)
    assert_allclose(rig.world, moved(-3, 0, 0), atol=1e-6)


def test_identities_alone_are_no_matrices(loaded):
    rig = loaded(limb(range(5), np.eye(4)))
    assert_allclose(rig.skeleton.joints, PLACES - PLACES[0], atol=1e-6)


def test_joints_of_a_file_at_the_origin_stay(loaded):
    builder = limb(range(5), np.eye(4))
    for node in builder.json["nodes"][:5]:
        del node["translation"]
    assert_allclose(loaded(builder).skeleton.joints, 0, atol=1e-6)


def test_a_skin_without_weights_has_its_good_joints_to_go_by(loaded):
    builder = limb((4,), np.eye(4))
    attributes = builder.json["meshes"][0]["primitives"][0]["attributes"]
    del attributes["JOINTS_0"], attributes["WEIGHTS_0"]
    assert_allclose(loaded(builder).skeleton.joints, PLACES, atol=1e-6)


def test_what_hangs_on_a_bad_joint_stands_at_its_node(loaded):
    builder = limb((2, 3, 4), BAD["times a scale"])
    builder.node(4, mesh=builder.mesh({"POSITION": builder.positions(COLUMN)}), name="hat")
    (hat,) = loaded(builder).attachments
    assert_allclose(hat.mesh.vertices, COLUMN + PLACES[4], atol=1e-5)


def lying(top):
    """Return a limb below a joint at the origin that holds nothing, and turns all by a quarter."""
    builder = limb()
    builder.node(name="top", rotation=QUARTER_X, children=[0])
    builder.json["scenes"][0]["nodes"].remove(0)
    inverse = [top, *(moved(*-p) for p in PLACES)]
    builder.json["skins"][0] = {
        "joints": [6, *range(5)],
        "inverseBindMatrices": builder.accessor(np.array(inverse)),
    }
    joints = np.zeros((12, 4), "u1")
    joints[:, :2] = 1, 2
    primitive = builder.json["meshes"][0]["primitives"][0]
    primitive["attributes"]["JOINTS_0"] = builder.accessor(joints)
    return builder


@pytest.mark.parametrize("top", [np.eye(4), TURN_X.T, np.diag([466.0, 466, 466, 1])])
def test_joints_that_hold_vertices_say_how_a_character_stands(loaded, top):
    rig = loaded(lying(top))
    assert_allclose(rig.world, TURN_X, atol=1e-6)
    assert_allclose(rig.skeleton.joints, [[0, 0, 0], *PLACES], atol=1e-6)


def test_most_weight_says_it_and_not_the_topmost_joint(loaded):
    """The root is posed, and back again in the joint that holds most."""
    builder = limb()
    builder.json["nodes"][0]["rotation"] = QUARTER_X
    back = np.linalg.inv(moved(*REST[0]) @ TURN_X) @ moved(*REST[1])
    del builder.json["nodes"][1]["translation"]
    builder.json["nodes"][1]["matrix"] = back.T.ravel().tolist()
    shares = np.zeros((12, 4), "f4")
    shares[:, 0], shares[:, 1] = 0.2, 0.8
    primitive = builder.json["meshes"][0]["primitives"][0]
    primitive["attributes"]["WEIGHTS_0"] = builder.accessor(shares)
    assert_allclose(loaded(builder).world, np.eye(4), atol=1e-6)


def two_limbs(first, second):
    """Return two limbs in bind spaces of their own, below one joint that has no good matrix."""
    builder = limb()
    builder.node(name="top", children=[0])
    builder.json["scenes"][0]["nodes"] = [5, 6]
    other = [
        builder.node(6 if above < 0 else 7 + above, name=f"other {k}", translation=t.tolist())
        for k, (above, t) in enumerate(
            zip((-1, 0), (REST[0] + np.array([4, 0, 0]), REST[1] - REST[0]), strict=True)
        )
    ]
    joints = np.zeros((12, 4), "u1")
    joints[:, :2] = 1, 2
    for mesh, (skin, offset) in enumerate(((first, [0, 0, 0]), (second, [7, 0, 0]))):
        nodes, places = ([0, 1], REST) if mesh == 0 else (other, REST)
        linear = skin[:3, :3]
        points = (COLUMN + np.float32(offset)) @ np.linalg.inv(linear).T
        inverse = [moved(*-(p + offset)) @ np.block([[linear, np.zeros((3, 1))], [0, 0, 0, 1]])
                   for p in places]  # fmt: skip
        number = builder.skin([6, *nodes], [np.eye(4), *inverse])
        attributes = builder.attributes(np.float32(points), joints)
        number_of_mesh = builder.mesh(attributes)
        builder.node(mesh=number_of_mesh, skin=number)
    builder.json["nodes"][5].pop("mesh")
    builder.json["nodes"][5].pop("skin")
    return builder


@pytest.mark.parametrize("linear", [np.eye(3), np.diag([-100.0, 100, 100]), 100 * TURN_X[:3, :3]])
def test_skins_that_share_only_a_bad_joint_meet_in_the_scene(loaded, linear):
    rig = loaded(two_limbs(np.eye(3), linear))
    assert_allclose(
        rig.mesh.vertices, np.concatenate([COLUMN, COLUMN + np.float32([4, 0, 0])]), atol=1e-4
    )
    assert_allclose(rig.skeleton.joints[3:], REST + np.array([4, 0, 0]), atol=1e-4)


def test_a_joint_that_another_skin_knows_better_is_taken_from_there(loaded):
    builder = limb((2,), np.eye(4))
    inverse = [moved(*-p) for p in PLACES[1:3]]
    mesh = builder.mesh(builder.attributes(COLUMN))
    builder.node(mesh=mesh, skin=builder.skin([1, 2], inverse))
    builder.json["nodes"][2]["rotation"] = QUARTER_X
    rig = loaded(builder)
    assert_allclose(rig.skeleton.joints[:3], PLACES[:3], atol=1e-6)
    assert not rig.warnings


def with_fewer(builder, count):
    """Return a builder whose skin has so many matrices only."""
    accessor = builder.json["skins"][0]["inverseBindMatrices"]
    builder.json["accessors"][accessor]["count"] = count
    return builder


@pytest.mark.parametrize("count", [1, 2, 3])
@pytest.mark.parametrize("offset", [(0, 0, 0), (0, 0, 3)])
def test_joints_without_a_matrix_stand_at_their_nodes(loaded, tmp_path, count, offset):
    rig = loaded(with_fewer(limb(offset=offset), count))  # with one, a joint holds vertices
    places = PLACES + offset
    assert_allclose(rig.skeleton.joints, places, atol=1e-6)
    (warning,) = rig.warnings
    assert f'{5 - count} joints (the first is "{rig.skeleton.names[count]}")' in warning
    assert "missing" in warning
    joints = places + np.linspace(0, 0.1, 15).reshape(5, 3)
    for end, changed in ((".glb", rig), (".gltf", rig), (".glb", rig.with_joints(joints))):
        cutcell.save(tmp_path / f"out{end}", on_end_and_far(changed))
        again = cutcell.load(tmp_path / f"out{end}")
        assert_allclose(again.skeleton.joints, changed.skeleton.joints, atol=1e-6)
        world, inverse = matrices(tmp_path / f"out{end}")
        assert len(inverse) == 5
        is_held = again.weights.any(axis=0)
        assert is_held.sum() == 2
        assert_allclose((world @ inverse)[is_held], [moved(*-np.array(offset))] * 2, atol=1e-6)


def test_with_the_identity_alone_all_joints_stand_at_their_nodes(loaded):
    all_of_them = loaded(limb((0, 1, 2, 3, 4), np.eye(4)))
    rig = loaded(with_fewer(limb((0, 1, 2, 3, 4), np.eye(4)), 2))
    assert_array_equal(rig.skeleton.joints, all_of_them.skeleton.joints)


def test_joints_are_removed_from_a_skin_with_fewer_matrices(loaded, tmp_path):
    rig = loaded(with_fewer(limb(), 2))
    other = cutcell.edited_rig(rig, cutcell.Edits(removed=("end",)))
    cutcell.save(tmp_path / "out.glb", other.with_weights(np.eye(4)[[3] * 12]))
    again = cutcell.load(tmp_path / "out.glb")
    assert_allclose(again.skeleton.joints, PLACES[[0, 1, 3, 4]], atol=1e-6)


def matrices(path):
    """Return the world matrices of a file's joints, and the inverse bind matrices as stored."""
    document = read_document(path)
    (skin,) = document.json["skins"]
    stored = read_accessor(document, skin["inverseBindMatrices"], "MAT4", "skin")
    world = Nodes(document).world[skin["joints"]]
    return world, stored[: len(world)].reshape(-1, 4, 4).transpose(0, 2, 1)


def on_end_and_far(rig):
    """Return a rig whose vertices hang on its joints "end" and "far"."""
    weights = np.zeros((len(rig.mesh.vertices), len(rig.skeleton.joints)))
    weights[:, [rig.skeleton.names.index("end"), rig.skeleton.names.index("far")]] = 0.5
    return replace(rig, weights=weights)


@pytest.mark.parametrize("matrix", BAD.values(), ids=BAD)
def test_a_joint_that_gets_weight_is_saved_with_a_good_matrix(loaded, tmp_path, matrix):
    rig = on_end_and_far(loaded(limb((2, 3, 4), matrix)))
    cutcell.save(tmp_path / "out.glb", rig)
    world, inverse = matrices(tmp_path / "out.glb")
    skinned = world @ inverse
    assert_allclose(skinned[[0, 1, 2, 4]], np.tile(np.eye(4), (4, 1, 1)), atol=1e-5)
    assert_allclose(inverse[3], matrix, atol=1e-6)  # it holds nothing: as it was in the file
    again = cutcell.load(tmp_path / "out.glb")
    assert_allclose(again.skeleton.joints, PLACES, atol=1e-5)
    assert '"beyond"' in again.warnings[0]
    before = (tmp_path / "out.glb").read_bytes()
    cutcell.save(tmp_path / "out.glb", again)
    assert (tmp_path / "out.glb").read_bytes() == before


def test_without_a_change_matrices_are_saved_as_they_were(loaded, tmp_path):
    rig = loaded(limb((2, 3, 4), BAD["times a scale"]))
    cutcell.save(tmp_path / "out.glb", rig)
    _, inverse = matrices(tmp_path / "out.glb")
    assert_array_equal(inverse[2:], np.tile(BAD["times a scale"], (3, 1, 1)))


@pytest.mark.parametrize("matrix", BAD.values(), ids=BAD)
def test_a_bad_joint_that_is_moved_is_saved_where_it_is(loaded, tmp_path, matrix):
    rig = loaded(limb((2, 3, 4), matrix))
    moved_to = PLACES.copy()
    moved_to[3] += [0.1, 0.2, 0.3]
    cutcell.save(tmp_path / "out.glb", on_end_and_far(rig.with_joints(moved_to)))
    again = cutcell.load(tmp_path / "out.glb")
    assert_allclose(again.skeleton.joints, moved_to, atol=1e-5)
    world, inverse = matrices(tmp_path / "out.glb")
    assert_allclose(world @ inverse, np.tile(np.eye(4), (5, 1, 1)), atol=1e-5)


def test_joints_are_added_to_a_skin_whose_first_joint_is_bad(loaded, tmp_path):
    rig = loaded(lying(np.diag([466.0, 466, 466, 1])))
    rig = replace(rig, weights=np.pad(rig.weights[:, 1:3], ((0, 0), (1, 3))))
    added = cutcell.JointEdit(added=True, parent="far", position=(0.5, 3, 0.5))
    change = cutcell.Edits({"new": added})
    changed = cutcell.edited_rig(rig, change)
    cutcell.save(tmp_path / "out.glb", changed.with_weights(np.eye(7)[[6] * 12]))
    world, inverse = matrices(tmp_path / "out.glb")
    assert_allclose(world[-1] @ inverse[-1], TURN_X, atol=1e-5)


@pytest.mark.parametrize("top", [np.eye(4), np.diag([466.0, 466, 466, 1])])
def test_a_root_that_stays_is_saved_with_a_matrix_that_moves_nothing(loaded, tmp_path, top):
    rig = loaded(lying(top))
    weights = np.zeros((12, 6))
    weights[:, 0] = 1
    cutcell.save(tmp_path / "out.glb", replace(rig, weights=weights))
    world, inverse = matrices(tmp_path / "out.glb")
    assert_allclose(world[0] @ inverse[0], TURN_X, atol=1e-5)
