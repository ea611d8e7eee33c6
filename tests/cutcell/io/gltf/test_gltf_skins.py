"""Joints, several skins and what hangs on joints: all stand where the file says."""

import numpy as np
from numpy.testing import assert_allclose, assert_array_equal

from tests.cutcell.io.gltf.gltf_builder import (
    COLUMN,
    FACES,
    REST,
    SHARES,
    Builder,
    check_column,
    column,
    moved,
    turned,
    two_skins,
)

QUARTER_X = [np.sqrt(0.5), 0, 0, np.sqrt(0.5)]


def test_the_mesh_node_does_not_matter_but_those_above_the_joints_do(loaded):
    builder = column()
    builder.json["nodes"][2] |= {"translation": [7, 7, 7], "scale": [3, 1, 2]}
    builder.json["scenes"][0]["nodes"] = [3, 2]
    scaled = {"scale": [2, 1, 4], "rotation": QUARTER_X, "translation": [0, 5, 0]}
    builder.add("nodes", scaled, name="armature", children=[0])
    rig = loaded(builder)
    check_column(rig)
    turn = np.array([[1, 0, 0, 0], [0, 0, -1, 5], [0, 1, 0, 0], [0, 0, 0, 1]])
    assert_allclose(rig.world, turn @ np.diag([2, 1, 4, 1]), atol=1e-7)


def test_flat_joints_without_names_or_with_the_same(loaded):
    builder = Builder()
    nodes = [builder.node(**({"name": n} if n else {})) for n in ("a", "", "a", "", "a (2)")]
    skin = builder.skin(nodes, [moved(0, -k / 4, 0) for k in range(5)])
    builder.node(mesh=builder.mesh(), skin=skin)
    skeleton = loaded(builder).skeleton
    assert (skeleton.parents == -1).all()
    assert skeleton.names == ("a", "joint 1", "a (3)", "joint 3", "a (2)")
    assert_allclose(skeleton.joints[:, 1], np.arange(5) / 4)


def test_a_joint_hangs_on_the_nearest_joint_above(loaded):
    builder = Builder()
    root = builder.node(name="root")
    between = builder.node(root, name="no joint", translation=[0, 1, 0])
    tip = builder.node(between, name="tip")
    skin = builder.skin([tip, root], [moved(0, -1, 0), np.eye(4)])
    builder.node(mesh=builder.mesh(), skin=skin)
    rig = loaded(builder)
    assert rig.skeleton.names == ("tip", "root")
    assert rig.skeleton.parents.tolist() == [1, -1]


def test_without_inverse_binds_joints_stand_where_their_nodes_do(loaded):
    builder = column()
    del builder.json["skins"][0]["inverseBindMatrices"]
    rig = loaded(builder)
    # Identity binds: the mesh is in the space of the first joint's node.
    assert_allclose(rig.skeleton.joints, REST - REST[0], atol=1e-7)
    assert_allclose(rig.world, moved(*REST[0]), atol=1e-7)


def test_a_second_skin_comes_into_the_space_of_the_first(loaded):
    rig = loaded(two_skins([3, 0, -2]))
    assert_allclose(rig.mesh.vertices, np.concatenate([COLUMN, COLUMN]), atol=1e-6)
    assert rig.skeleton.names == ("root", "tip", "extra")
    assert_allclose(rig.skeleton.joints, [*REST, REST[1] + [0, 1, 0]], atol=1e-6)
    assert_array_equal(rig.mesh.faces[len(FACES) :], FACES + 12)
    assert_allclose(rig.weights[:12, :2], SHARES[:, :2])
    assert_allclose(rig.weights[12:, 1:], SHARES[:, :2])


def test_a_vertex_may_use_the_joints_of_its_own_skin_only(loaded):
    rig = loaded(two_skins([3, 0, -2]))
    assert_array_equal(rig.allowed[0], [True, True, False])
    assert_array_equal(rig.allowed[12], [False, True, True])


def test_skins_without_a_common_joint_meet_in_the_scene(loaded):
    rig = loaded(two_skins([3, 0, -2], shared=False))
    assert_allclose(rig.mesh.vertices, np.concatenate([COLUMN, COLUMN]), atol=1e-6)
    assert_allclose(rig.skeleton.joints, [*REST, *REST], atol=1e-6)


def test_a_mirrored_skin_keeps_its_outside(loaded):
    builder = two_skins([0, 0, 0], shared=False)
    mirror = np.diag([-1.0, 1, 1, 1])
    builder.json["skins"][1]["inverseBindMatrices"] = builder.accessor(
        np.array([moved(*-p) @ mirror for p in REST])
    )
    rig = loaded(builder)
    assert_allclose(rig.mesh.vertices[12:], COLUMN * [-1, 1, 1], atol=1e-6)
    assert turned(rig.mesh.faces[len(FACES) :] - 12) == turned(FACES[:, ::-1])


def test_a_mesh_in_two_places_is_read_for_the_first_skin(loaded):
    builder = column()
    other = builder.node(name="other")
    skin = builder.skin([other, builder.node(other, name="other tip")], [np.eye(4)] * 2)
    builder.node(mesh=0, skin=skin)
    rig = loaded(builder)
    assert len(rig.mesh.vertices) == 12


def test_only_the_default_scene_is_read(loaded):
    builder = two_skins([3, 0, -2], shared=False)
    builder.add("scenes", {"nodes": [builder.json["scenes"][0]["nodes"].pop()]})
    assert len(loaded(builder).mesh.vertices) == 12


def test_a_mesh_on_a_joint_is_attached_and_stands_right(loaded):
    """A sword 1 above the tip's node, which at rest is turned away from its bind."""
    builder = column()
    builder.json["nodes"][1]["rotation"] = QUARTER_X
    holder = builder.node(1, translation=[0, 1, 0], scale=[2, 2, 2])
    plain = builder.mesh({"POSITION": builder.positions(COLUMN)})
    builder.node(holder, name="sword", mesh=plain)
    builder.node(name="ground", mesh=plain)
    rig = loaded(builder)
    (sword,) = rig.attachments
    assert (sword.name, sword.joint) == ("sword", 1)
    assert_allclose(sword.mesh.vertices, COLUMN * 2 + [0.5, 2, 0.5], atol=1e-6)
    assert len(rig.mesh.vertices) == 12


def test_a_hidden_attachment_is_read_too(loaded):
    builder = column()
    builder.json["nodes"][1]["scale"] = [0, 0, 0]
    plain = builder.mesh({"POSITION": builder.positions(COLUMN)})
    builder.node(1, mesh=plain)
    (sword,) = loaded(builder).attachments
    assert sword.name == "attachment 0"
    assert_allclose(sword.mesh.vertices, COLUMN + REST[1], atol=1e-6)


def test_inverse_binds_tell_how_joints_are_turned_at_rest(loaded):
    builder = Builder()
    nodes = [builder.node(name=name) for name in "ab"]
    quarter = np.array([[0, -1, 0, 0], [1, 0, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1.0]])
    stretched = np.linalg.inv(quarter @ np.diag([2.0, 3.0, 4.0, 1.0]))
    builder.node(mesh=builder.mesh(), skin=builder.skin(nodes, [np.eye(4), stretched]))
    axes = loaded(builder).skeleton.orientations
    assert_allclose(axes, [np.eye(3), quarter[:3, :3]], atol=1e-6)
