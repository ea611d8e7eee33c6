"""Rows of weights that do not change keep the bytes that the file stores."""

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

import cutcell
from cutcell.io.gltf.container import read_document
from cutcell.io.gltf.read.accessors import find_accessor
from tests.cutcell.io.gltf.gltf_builder import COLUMN, Builder, column, moved

NAMES = ("JOINTS_0", "WEIGHTS_0", "JOINTS_1", "WEIGHTS_1")
SHARES = {"u1": 255, "u2": 65535, "f4": 1}


def rows_of(path):
    """Return the stored rows of each influence attribute, as bytes."""
    document = read_document(path)
    (primitive,) = document.json["meshes"][0]["primitives"]
    attributes = primitive["attributes"]
    arrays = {
        name: find_accessor(document, attributes[name], "VEC4", name).stored
        for name in NAMES
        if name in attributes
    }
    return {name: [row.tobytes() for row in array] for name, array in arrays.items()}


def influences(kind, sets, joints="u1"):
    """Return slots of a column in an order that no writer would choose, with unused slots."""
    rng = np.random.default_rng(0)
    top = SHARES[kind]
    share = np.zeros((12, 4 * sets))
    share[:, 1] = rng.integers(0, 100, 12) * top // 255 if top > 1 else rng.random(12) / 2
    share[:, 3] = rng.integers(0, 20, 12) * top // 255 if top > 1 else rng.random(12) / 4
    share[:, 4 * sets - 4] += top - share.sum(axis=1)
    where = rng.integers(0, 2, share.shape)
    where[:, [1, 3]] = 0, 1
    return where.astype(joints), share.astype(kind)


def layout(kind, sets=1, interleaved=False, sparse=False, nan=False, joints="u1"):
    builder = Builder()
    where, share = influences(kind, sets, joints)
    if nan:
        share[3] = [np.nan, 0.25, 0.75, 0]
        share[5] = [0.25, 0.125, -0.125, 0]
    arrays = [a[:, 4 * n : 4 * n + 4] for n in range(sets) for a in (where, share)]
    positions = builder.positions(COLUMN)
    if interleaved:
        positions, *result = builder.interleaved(COLUMN, *arrays)
    else:
        result = [builder.accessor(array) for array in arrays]
    for accessor in result[1::2]:
        if kind != "f4":
            builder.json["accessors"][accessor]["normalized"] = True
        if sparse:
            item = builder.json["accessors"][accessor]
            rows = np.array([2, 7], "u2")
            item["sparse"] = {
                "count": 2,
                "indices": {"bufferView": builder.view(rows.tobytes()), "componentType": 5123},
                "values": {"bufferView": builder.view(share[[9, 4], :4].tobytes())},
            }
    attributes = {"POSITION": positions, **dict(zip(NAMES, result, strict=False))}
    mesh = builder.mesh(attributes)
    root = builder.node(name="root")
    tip = builder.node(root, name="tip", translation=[0, 1, 0])
    inverse = [moved(-0.5, 0, -0.5), moved(-0.5, -1, -0.5)]
    builder.node(mesh=mesh, skin=builder.skin([root, tip], inverse))
    return builder


LAYOUTS = {
    "float": {"kind": "f4"},
    "bytes": {"kind": "u1"},
    "shorts": {"kind": "u2", "joints": "u2"},
    "two sets": {"kind": "f4", "sets": 2},
    "two sets of bytes": {"kind": "u1", "sets": 2},
    "interleaved": {"kind": "f4", "interleaved": True},
    "interleaved bytes": {"kind": "u1", "interleaved": True},
    "sparse": {"kind": "f4", "sparse": True},
    "sparse shorts": {"kind": "u2", "sparse": True},
    "no numbers": {"kind": "f4", "nan": True},
}


@pytest.fixture(params=LAYOUTS.values(), ids=LAYOUTS)
def path(request, tmp_path):
    return layout(**request.param).save(tmp_path / "in.glb")


@pytest.mark.parametrize("rounds", [False, True])
def test_without_a_change_all_bytes_stay(path, tmp_path, rounds):
    rig = cutcell.load(path)
    weights = rig.weights * (1 + 2e-16 * rounds)
    cutcell.save(tmp_path / "out.glb", rig.with_weights(weights))
    assert rows_of(tmp_path / "out.glb") == rows_of(path)


def test_after_a_local_change_all_other_rows_are_the_same_bytes(path, tmp_path):
    rig = cutcell.load(path)
    weights, changed = rig.weights.copy(), [4, 9]
    weights[changed] = [[0.375, 0.625], [0.0, 1.0]]
    cutcell.save(tmp_path / "out.glb", rig.with_weights(weights))
    before, after = rows_of(path), rows_of(tmp_path / "out.glb")
    assert before.keys() == after.keys()
    for name, rows in before.items():
        same = [row == new for row, new in zip(rows, after[name], strict=True)]
        assert all(same[v] for v in range(12) if v not in changed), name
    again = cutcell.load(tmp_path / "out.glb").weights
    assert_allclose(again[changed], weights[changed], atol=1 / 255)
    others = np.setdiff1d(np.arange(12), changed)
    assert_array_equal(again[others], rig.weights[others])


def test_integers_become_floats_where_most_weights_are_new(tmp_path):
    rig = cutcell.load(layout("u1").save(tmp_path / "in.glb"))
    weights = np.random.default_rng(1).dirichlet([1, 1], 12)
    weights[:3] = rig.weights[:3]
    cutcell.save(tmp_path / "out.glb", rig.with_weights(weights))
    assert_allclose(cutcell.load(tmp_path / "out.glb").weights, weights, atol=1e-7)


@pytest.mark.parametrize("kind", ["u1", "u2"])
def test_rows_of_integers_sum_to_one_and_are_as_near_as_they_can_be(tmp_path, kind):
    rig = cutcell.load(layout(kind).save(tmp_path / "in.glb"))
    weights = rig.weights.copy()
    weights[0] = [1 / 3, 2 / 3]
    cutcell.save(tmp_path / "out.glb", rig.with_weights(weights))
    row = np.frombuffer(rows_of(tmp_path / "out.glb")["WEIGHTS_0"][0], kind)
    top = np.iinfo(kind).max
    assert row.sum() == top
    assert_array_equal(np.sort(row)[::-1][:2], [round(top * 2 / 3), round(top / 3)])


def test_more_sets_are_added_where_a_row_needs_them(tmp_path):
    rig = cutcell.load(many_joints().save(tmp_path / "in.glb"))
    weights = rig.weights.copy()
    weights[0] = 1 / 6
    cutcell.save(tmp_path / "out.glb", rig.with_weights(weights))
    before, after = rows_of(tmp_path / "in.glb"), rows_of(tmp_path / "out.glb")
    assert after.keys() == set(NAMES)
    for name, rows in before.items():
        assert rows[1:] == after[name][1:]
    assert set(after["WEIGHTS_1"][1:]) == {bytes(4)}
    assert_allclose(cutcell.load(tmp_path / "out.glb").weights[0], 1 / 6, atol=1 / 255)


def many_joints():
    """Return a column of six joints whose weights are bytes."""
    builder = layout("u1")
    (skin,) = builder.json["skins"]
    for _ in range(4):
        skin["joints"].append(builder.node(skin["joints"][-1], translation=[0, 0.2, 0]))
    inverse = [moved(-0.5, -y, -0.5) for y in (0, 1, 1.2, 1.4, 1.6, 1.8)]
    skin["inverseBindMatrices"] = builder.accessor(np.array(inverse))
    return builder


def test_repaired_rows_are_written_anew(tmp_path):
    rig = cutcell.load(layout("f4", nan=True).save(tmp_path / "in.glb"))
    result = cutcell.diagnose(rig, 16)
    repaired = result.repaired(["invalid-weights"]).rig
    cutcell.save(tmp_path / "out.glb", repaired.with_weights(repaired.weights))
    assert "invalid-weights" not in cutcell.diagnose(cutcell.load(tmp_path / "out.glb"), 16)
    before, after = rows_of(tmp_path / "in.glb"), rows_of(tmp_path / "out.glb")
    same = [a == b for a, b in zip(before["WEIGHTS_0"], after["WEIGHTS_0"], strict=True)]
    assert_array_equal(np.flatnonzero(~np.array(same)), [3, 5])


def test_rows_stay_where_a_joint_is_added(tmp_path):
    rig = cutcell.load(column().save(tmp_path / "in.glb"))
    end = cutcell.JointEdit(added=True, position=(0.5, 2, 0.5), parent="tip")
    added = cutcell.edited_rig(rig, cutcell.Edits({"end": end}))
    cutcell.save(tmp_path / "out.glb", added)
    assert rows_of(tmp_path / "out.glb") == rows_of(tmp_path / "in.glb")
