"""Every way in which glTF can store a character gives the same rig."""

import json

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

import cutcell
from tests.cutcell.io.gltf_builder import (
    COLUMN,
    FACES,
    JOINTS,
    REST,
    SHARES,
    Builder,
    column,
    moved,
)

QUARTER_X = [np.sqrt(0.5), 0, 0, np.sqrt(0.5)]


def check_column(rig, tolerance=1e-6):
    assert_allclose(rig.mesh.vertices, COLUMN, atol=tolerance)
    assert_allclose(rig.weights, SHARES[:, :2], atol=tolerance)
    assert_allclose(rig.skeleton.joints, REST, atol=tolerance)
    assert rig.skeleton.parents.tolist() == [-1, 0]
    assert rig.skeleton.names == ("root", "tip")


def turned(primitive):
    """Put a primitive's corners in canonical order, each face starting at its least one."""
    return sorted(tuple(np.roll(f, -np.argmin(f)).tolist()) for f in primitive)


@pytest.mark.parametrize("name", ["rig.glb", "rig.gltf"])
def test_a_plain_rig(loaded, name):
    rig = loaded(column(), name)
    check_column(rig)
    assert_array_equal(rig.mesh.faces, FACES)
    assert rig.skeleton.deform.all()
    assert rig.name == "rig"
    assert rig.allowed is None
    assert_allclose(rig.world, np.eye(4))


def test_buffers_in_files_beside_the_document(tmp_path):
    builder = column()
    builder.json["buffers"] = [{"uri": "a%20folder/data.bin"}]
    (tmp_path / "a folder").mkdir()
    (tmp_path / "a folder" / "data.bin").write_bytes(builder.data)
    (tmp_path / "rig.gltf").write_text(json.dumps(builder.finished()))
    check_column(cutcell.load(tmp_path / "rig.gltf"))


def test_without_an_index_buffer_every_three_vertices_are_a_face(loaded):
    builder = column()
    corners = FACES.reshape(-1)
    primitive = builder.json["meshes"][0]["primitives"][0]
    primitive["attributes"] = builder.attributes(COLUMN[corners], JOINTS[corners], SHARES[corners])
    del primitive["indices"]
    rig = loaded(builder)
    assert_array_equal(rig.mesh.faces, np.arange(len(corners)).reshape(-1, 3))
    assert_allclose(rig.mesh.vertices, COLUMN[corners])
    assert_allclose(rig.weights, SHARES[corners, :2])


def test_strips_turn_every_second_triangle_and_drop_flat_ones(loaded):
    builder = column(faces=[0, 4, 1, 5, 2, 6, 6, 8, 8, 9, 10])
    builder.json["meshes"][0]["primitives"][0]["mode"] = 5
    expected = [[0, 4, 1], [1, 4, 5], [1, 5, 2], [2, 5, 6], [8, 9, 10]]
    assert turned(loaded(builder).mesh.faces) == turned(expected)


def test_fans_share_their_first_vertex(loaded):
    builder = column(faces=[0, 1, 2, 3, 7])
    builder.json["meshes"][0]["primitives"][0]["mode"] = 6
    assert turned(loaded(builder).mesh.faces) == turned([[0, 1, 2], [0, 2, 3], [0, 3, 7]])


def test_points_and_lines_are_passed_over(loaded):
    builder = column()
    primitives = builder.json["meshes"][0]["primitives"]
    primitives.insert(0, {**primitives[0], "mode": 1})
    rig = loaded(builder)
    check_column(rig)
    assert len(rig.mesh.faces) == len(FACES)


@pytest.mark.parametrize("joints", ["u1", "u2"])
@pytest.mark.parametrize(("shares", "largest"), [("f4", 1), ("u1", 255), ("u2", 65535)])
def test_every_component_type_of_influences(loaded, joints, shares, largest):
    builder = column()
    stored = SHARES if shares == "f4" else np.round(SHARES * largest).astype(shares)
    builder.json["meshes"][0]["primitives"][0]["attributes"] |= {
        "JOINTS_0": builder.accessor(JOINTS.astype(joints)),
        "WEIGHTS_0": builder.accessor(stored, normalized=shares != "f4"),
    }
    check_column(loaded(builder), tolerance=2 / largest if largest > 1 else 1e-7)


def test_several_sets_of_influences_and_joints_named_twice(loaded):
    builder = Builder()
    nodes = [builder.node(name=f"j{k}") for k in range(6)]
    binds = [moved(0, -k / 4, 0) for k in range(6)]
    rng = np.random.default_rng(1)
    shares = rng.random((12, 8)).astype("f4")  # not normalised: that is done on loading
    joints = np.tile(np.array([0, 1, 2, 3, 4, 5, 5, 0], "u1"), (12, 1))
    found = builder.attributes(COLUMN, joints[:, :4], shares[:, :4])
    found |= {
        "JOINTS_1": builder.accessor(joints[:, 4:]),
        "WEIGHTS_1": builder.accessor(shares[:, 4:]),
    }
    builder.node(mesh=builder.mesh(found), skin=builder.skin(nodes, binds))
    expected = shares[:, :6].astype(float)
    expected[:, 5] += shares[:, 6]
    expected[:, 0] += shares[:, 7]
    expected /= expected.sum(axis=1, keepdims=True)
    assert_allclose(loaded(builder).weights, expected, atol=1e-12)


def test_rows_without_weight_stay_so_and_joints_without_weight_do_not_deform(loaded):
    shares = SHARES.copy()
    shares[:, 1] = 0
    builder = column()
    found = builder.json["meshes"][0]["primitives"][0]["attributes"]
    found["WEIGHTS_0"] = builder.accessor(shares)
    rig = loaded(builder)
    assert (rig.weights[8:] == 0).all()
    assert rig.skeleton.deform.tolist() == [True, False]


def test_a_skinned_mesh_without_weights_yet(loaded):
    builder = column()
    found = builder.json["meshes"][0]["primitives"][0]["attributes"]
    del found["JOINTS_0"], found["WEIGHTS_0"]
    rig = loaded(builder)
    assert rig.weights is None
    assert rig.skeleton.deform.all()


def test_sparse_accessors_with_and_without_a_base(loaded):
    builder = column()
    found = builder.json["meshes"][0]["primitives"][0]["attributes"]
    wrong = COLUMN.copy()
    wrong[[3, 7]] = 99
    for name, base, right, rows in (
        ("POSITION", wrong, COLUMN, [3, 7]),
        ("WEIGHTS_0", None, SHARES, range(12)),
    ):
        rows = np.array(rows, "u1")
        sparse = {
            "count": len(rows),
            "indices": {"bufferView": builder.view(rows.tobytes()), "componentType": 5121},
            "values": {"bufferView": builder.view(right[rows].tobytes())},
        }
        found[name] = builder.accessor(right if base is None else base, sparse=sparse)
        if base is None:
            del builder.json["accessors"][found[name]]["bufferView"]
    check_column(loaded(builder))


def test_interleaved_vertices(loaded):
    builder = column()
    position, joints, shares = builder.interleaved(COLUMN, JOINTS, SHARES)
    builder.json["meshes"][0]["primitives"][0]["attributes"] = {
        "POSITION": position,
        "JOINTS_0": joints,
        "WEIGHTS_0": shares,
    }
    check_column(loaded(builder))


def test_quantised_positions_and_a_scaled_bind(loaded):
    """KHR_mesh_quantization: the inverse binds bring the integers back to size."""
    builder = column()
    stored = np.zeros((12, 4), "i2")  # rows are padded to 8 bytes
    stored[:, :3] = np.round(COLUMN / 2 * 32767)
    view = builder.view(stored.tobytes(), byteStride=8, target=34962)
    item = {"bufferView": view, "componentType": 5122, "normalized": True, "count": 12}
    builder.json["meshes"][0]["primitives"][0]["attributes"]["POSITION"] = builder.add(
        "accessors", item, type="VEC3"
    )
    double = np.diag([2.0, 2, 2, 1])
    builder.json["skins"][0]["inverseBindMatrices"] = builder.accessor(
        np.array([moved(*-p) @ double for p in REST])
    )
    rig = loaded(builder)
    assert_allclose(rig.mesh.vertices, COLUMN / 2, atol=1e-4)
    assert_allclose(rig.skeleton.joints, REST / 2, atol=1e-7)
    assert_allclose(rig.world, double, atol=1e-7)


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


def two_skins(second_offset, shared=True):
    """Return a builder with the column twice, the second time stored off by an offset."""
    builder = column()
    inverse = [moved(*-p) @ moved(*-np.array(second_offset)) for p in REST]
    if shared:
        extra = builder.node(1, name="extra", translation=[0, 1, 0])
        joints, inverse = [1, extra], [inverse[1], moved(0, -1, 0) @ inverse[1]]
    else:
        joints = [builder.node(name="r2", translation=REST[0].tolist())]
        joints.append(builder.node(joints[0], name="t2", translation=[0, 1, 0]))
    skin = builder.skin(joints, inverse)
    mesh = builder.mesh(builder.attributes(COLUMN + np.float32(second_offset)), name="second")
    builder.node(name="second", mesh=mesh, skin=skin)
    return builder


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


def test_primitives_that_share_vertices_count_them_once(loaded):
    builder = column()
    primitives = builder.json["meshes"][0]["primitives"]
    half = len(FACES) // 2
    primitives[0]["indices"] = builder.accessor(FACES[:half].reshape(-1))
    primitives.append({**primitives[0], "indices": builder.accessor(FACES[half:].reshape(-1))})
    rig = loaded(builder)
    check_column(rig)
    assert_array_equal(rig.mesh.faces, FACES)


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


def test_real_characters_match_what_others_read(rigs):
    """The positions that Blender saw in the same files."""
    from scipy.spatial import cKDTree

    for path in rigs:
        reference = path.parent.parent / "bone_heat" / f"{path.stem}.npz"
        seen = np.load(reference)["vertices"]
        rig = cutcell.load(path)
        size = np.linalg.norm(np.ptp(seen, axis=0))
        assert cKDTree(rig.mesh.vertices).query(seen)[0].max() < 1e-6 * size, path.name
        assert cKDTree(seen).query(rig.mesh.vertices)[0].max() < 1e-6 * size, path.name
        assert_allclose(rig.weights.sum(axis=1), 1, atol=1e-9, err_msg=path.name)
