"""Every way in which glTF can store a character gives the same rig."""

import json

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

import cutcell
from tests.cutcell.io.gltf.gltf_builder import (
    COLUMN,
    FACES,
    JOINTS,
    REST,
    SHARES,
    Builder,
    check_column,
    column,
    moved,
    turned,
)


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
    result = builder.attributes(COLUMN, joints[:, :4], shares[:, :4])
    result |= {
        "JOINTS_1": builder.accessor(joints[:, 4:]),
        "WEIGHTS_1": builder.accessor(shares[:, 4:]),
    }
    builder.node(mesh=builder.mesh(result), skin=builder.skin(nodes, binds))
    expected = shares[:, :6].astype(float)
    expected[:, 5] += shares[:, 6]
    expected[:, 0] += shares[:, 7]
    expected /= expected.sum(axis=1, keepdims=True)
    assert_allclose(loaded(builder).weights, expected, atol=1e-12)


def test_rows_without_weight_stay_so_and_joints_without_weight_do_not_deform(loaded):
    shares = SHARES.copy()
    shares[:, 1] = 0
    builder = column()
    result = builder.json["meshes"][0]["primitives"][0]["attributes"]
    result["WEIGHTS_0"] = builder.accessor(shares)
    rig = loaded(builder)
    assert (rig.weights[8:] == 0).all()
    assert rig.skeleton.deform.tolist() == [True, False]


def test_a_skinned_mesh_without_weights_yet(loaded):
    builder = column()
    result = builder.json["meshes"][0]["primitives"][0]["attributes"]
    del result["JOINTS_0"], result["WEIGHTS_0"]
    rig = loaded(builder)
    assert rig.weights is None
    assert rig.skeleton.deform.all()


def test_sparse_accessors_with_and_without_a_base(loaded):
    builder = column()
    result = builder.json["meshes"][0]["primitives"][0]["attributes"]
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
        result[name] = builder.accessor(right if base is None else base, sparse=sparse)
        if base is None:
            del builder.json["accessors"][result[name]]["bufferView"]
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


def test_primitives_that_share_vertices_count_them_once(loaded):
    builder = column()
    primitives = builder.json["meshes"][0]["primitives"]
    half = len(FACES) // 2
    primitives[0]["indices"] = builder.accessor(FACES[:half].reshape(-1))
    primitives.append({**primitives[0], "indices": builder.accessor(FACES[half:].reshape(-1))})
    rig = loaded(builder)
    check_column(rig)
    assert_array_equal(rig.mesh.faces, FACES)


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
