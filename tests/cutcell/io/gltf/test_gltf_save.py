"""Saving changes the skin weights and nothing else."""

import json
import os

import numpy as np
import pygltflib
import pytest
from numpy.testing import assert_allclose, assert_array_equal

import cutcell
from cutcell.io.gltf.container import read_document
from cutcell.io.gltf.read.accessors import read_accessor
from tests.cutcell.io.gltf.gltf_builder import (
    COLUMN,
    FACES,
    JOINTS,
    SHARES,
    Builder,
    column,
    moved,
    two_skins,
)
from tests.gltf_validator.validator import errors, reports

STORED_ELSEWHERE = ("accessors", "bufferViews", "buffers", "meshes", "skins")


def random_weights(rig, most, seed=0):
    """Return sparse weights that the rig's file can store."""
    rng = np.random.default_rng(seed)
    allowed = np.ones((1, 1), bool) if rig.allowed is None else rig.allowed
    shape = len(rig.mesh.vertices), len(rig.skeleton.joints)
    draw = rng.random(shape) * allowed
    cut = -np.sort(-draw, axis=1)[:, min(most, shape[1]) - 1 : min(most, shape[1])]
    weights = np.where(draw >= cut, draw, 0) ** 3
    return weights / weights.sum(axis=1, keepdims=True)


def without_influences(meshes):
    meshes = json.loads(json.dumps(meshes))
    for mesh in meshes:
        for primitive in mesh["primitives"]:
            result = primitive["attributes"]
            for name in [k for k in result if k.startswith(("JOINTS_", "WEIGHTS_"))]:
                del result[name]
    return meshes


def without_deform(skins):
    """Return skins without what cutcell adds to their extras."""
    skins = json.loads(json.dumps(skins))
    for skin in skins:
        if isinstance(skin.get("extras"), dict):
            skin["extras"].pop("cutcell_deform", None)
            if not skin["extras"]:
                del skin["extras"]
    return skins


def referenced(document):
    """Return {where: (accessor, type)} for all accessors but the influences."""
    result = {}
    for i, mesh in enumerate(document.items("meshes")):
        for k, primitive in enumerate(mesh["primitives"]):
            uses = {**primitive["attributes"], "indices": primitive.get("indices")}
            for name, index in uses.items():
                if index is not None and not name.startswith(("JOINTS_", "WEIGHTS_")):
                    result[f"mesh {i} {k} {name}"] = index
    for i, skin in enumerate(document.items("skins")):
        if "inverseBindMatrices" in skin:
            result[f"skin {i}"] = skin["inverseBindMatrices"]
    for i, animation in enumerate(document.items("animations")):
        for k, sampler in enumerate(animation["samplers"]):
            result[f"clip {i} {k} in"], result[f"clip {i} {k} out"] = (
                sampler["input"],
                sampler["output"],
            )
    return result


def check_nothing_else_changed(before, after):
    """Compare two documents as JSON and as decoded data."""
    for key in {*before.json, *after.json} - set(STORED_ELSEWHERE):
        assert before.json.get(key) == after.json.get(key), key
    assert without_influences(before.json["meshes"]) == without_influences(after.json["meshes"])
    assert without_deform(before.json["skins"]) == without_deform(after.json["skins"])
    uses = referenced(before)
    assert uses == referenced(after)
    for where, index in uses.items():
        kind = before.json["accessors"][index]["type"]
        a, b = (read_accessor(d, index, kind, where) for d in (before, after))
        assert_array_equal(a, b, err_msg=where)
        assert a.dtype == b.dtype
    for image in before.items("images"):
        if "bufferView" in image:
            contents = []
            for d in (before, after):
                view = d.json["bufferViews"][image["bufferView"]]
                start = view.get("byteOffset", 0)
                contents.append(d.buffers[view["buffer"]][start : start + view["byteLength"]])
            assert contents[0] == contents[1]


def check_round_trip(path, out, most):
    rig = cutcell.load(path)
    weights = random_weights(rig, most)
    cutcell.save(out, rig.with_weights(weights))
    again = cutcell.load(out)
    assert_allclose(again.weights, weights, atol=2e-7)
    assert_allclose(again.weights.sum(axis=1), 1, atol=1e-12)
    assert_array_equal(again.mesh.vertices, rig.mesh.vertices)
    assert_array_equal(again.mesh.faces, rig.mesh.faces)
    assert_array_equal(again.skeleton.joints, rig.skeleton.joints)
    check_nothing_else_changed(read_document(path), read_document(out))
    sets = -(-most // 4)
    for part in again.source.parts:
        mesh, primitive = part.primitives[0]
        result = again.source.document.json["meshes"][mesh]["primitives"][primitive]["attributes"]
        limit = min(most, len(part.joints))
        assert sum(k.startswith("JOINTS_") for k in result) == min(sets, -(-limit // 4))
    return again


def add_third_party(builder):
    """Put in what cutcell does not know, and what pygltflib would lose."""
    builder.json["extras"] = {"author": "Zoë \ud83d\ude00", "empty": [], "none": None}
    builder.json["extensionsUsed"] = ["ACME_thing"]
    builder.json["extensions"] = {"ACME_thing": {"list": [], "view": 0, "deep": {"a": {}}}}
    builder.json["nodes"][1] |= {"extras": 5, "extensions": {"ACME_thing": {}}}
    primitive = builder.json["meshes"][0]["primitives"][0]
    primitive["extensions"] = {"ACME_thing": {"x": None}}
    primitive["attributes"] |= {
        "_HEAT": builder.accessor(np.arange(12.0)),
        "TEXCOORD_0": builder.accessor(COLUMN[:, :2]),
    }
    primitive["targets"] = [{"POSITION": builder.positions(COLUMN * 0.1)}]
    builder.add("materials", {"name": "skin", "pbrMetallicRoughness": {"metallicFactor": 0}})
    primitive["material"] = 0
    builder.add("cameras", {"type": "perspective", "perspective": {"yfov": 1.0, "znear": 0.1}})
    builder.json["skins"][0]["inverseBindMatrices"] = builder.accessor(
        np.array([moved(-0.5, -y, -0.5) for y in (0, 1)])
    )


def interleaved():
    builder = column()
    primitive = builder.json["meshes"][0]["primitives"][0]
    position, joints, shares = builder.interleaved(COLUMN, JOINTS, SHARES)
    primitive["attributes"] = {"POSITION": position, "JOINTS_0": joints, "WEIGHTS_0": shares}
    return builder


def normalised_bytes():
    builder = column()
    result = builder.json["meshes"][0]["primitives"][0]["attributes"]
    result["WEIGHTS_0"] = builder.accessor(np.round(SHARES * 255).astype("u1"), normalized=True)
    return builder


def sparse_weights():
    builder = column()
    result = builder.json["meshes"][0]["primitives"][0]["attributes"]
    values = {"bufferView": builder.view(SHARES[:2].tobytes())}
    rows = {"bufferView": builder.view(b"\0\1"), "componentType": 5121}
    sparse = {"count": 2, "indices": rows, "values": values}
    result["WEIGHTS_0"] = builder.accessor(SHARES, sparse=sparse)
    return builder


def weights_shared_with_an_attribute():
    builder = column()
    result = builder.json["meshes"][0]["primitives"][0]["attributes"]
    result["_COPY"] = result["WEIGHTS_0"]
    return builder


def overlapping_views():
    """Interleaved, each attribute with a view of its own over the same bytes."""
    builder = interleaved()
    view = builder.json["bufferViews"][-1]
    for accessor in builder.json["accessors"][-3:]:
        offset = accessor.pop("byteOffset")
        place = {**view, "byteOffset": view["byteOffset"] + offset}
        place["byteLength"] = view["byteLength"] - offset
        accessor["bufferView"] = builder.add("bufferViews", place)
    return builder


def many_joints():
    builder = Builder()
    nodes = [builder.node(name=f"j{k}") for k in range(300)]
    skin = builder.skin(nodes, [moved(0, -k / 150, 0) for k in range(300)])
    builder.node(mesh=builder.mesh(), skin=skin)
    return builder


def not_bound_yet():
    builder = column()
    result = builder.json["meshes"][0]["primitives"][0]["attributes"]
    del result["JOINTS_0"], result["WEIGHTS_0"]
    return builder


def shared_vertices():
    builder = column()
    primitives = builder.json["meshes"][0]["primitives"]
    primitives.append({**primitives[0], "indices": builder.accessor(FACES[:3].reshape(-1))})
    return builder


BUILDERS = [
    column,
    interleaved,
    normalised_bytes,
    sparse_weights,
    weights_shared_with_an_attribute,
    overlapping_views,
    many_joints,
    not_bound_yet,
    shared_vertices,
    lambda: two_skins([3, 0, -2]),
]


@pytest.mark.parametrize("make", BUILDERS)
@pytest.mark.parametrize("end", [".glb", ".gltf"])
def test_only_the_weights_change(tmp_path, make, end):
    paths = [make().save(tmp_path / f"in{end}")]
    for most in (4, 8, 2):
        paths.append(tmp_path / f"out{most}{end}")
        check_round_trip(paths[-2], paths[-1], most)
    expected, *result = map(errors, reports(*paths))
    assert [new - expected for new in result] == [{}] * 3


def test_unknown_fields_survive(tmp_path):
    builder = column()
    add_third_party(builder)
    path, out = builder.save(tmp_path / "in.glb"), tmp_path / "out.glb"
    check_round_trip(path, out, 4)
    first = read_document(path).json["meshes"][0]["primitives"][0]
    second = read_document(out).json["meshes"][0]["primitives"][0]
    assert first == second


def test_unknown_chunks_survive(tmp_path):
    content = column().glb()
    body = (4).to_bytes(4, "little") + b"ACMEabcd"
    content = content[:8] + (len(content) + len(body)).to_bytes(4, "little") + content[12:] + body
    (tmp_path / "in.glb").write_bytes(content)
    cutcell.save(tmp_path / "out.glb", cutcell.load(tmp_path / "in.glb"))
    assert (tmp_path / "out.glb").read_bytes().endswith(body)


@pytest.mark.parametrize("make", [column, sparse_weights, many_joints])
def test_the_bytes_of_the_old_values_go(tmp_path, make):
    path = make().save(tmp_path / "in.glb")
    rig = cutcell.load(path)
    cutcell.save(tmp_path / "out.glb", rig.with_weights(random_weights(rig, 4)))
    before, after = read_document(path), read_document(tmp_path / "out.glb")
    # 300 joints no longer fit in bytes, so there the numbers take twice the room.
    grown = 12 * 4 if make is many_joints else 0
    assert len(after.buffers[0]) <= len(before.buffers[0]) + grown + 8


@pytest.mark.parametrize("make", BUILDERS)
def test_saving_again_and_again_does_not_pile_up(tmp_path, make):
    path = make().save(tmp_path / "rig.glb")
    sizes = []
    for turn in range(6):
        rig = cutcell.load(path)
        cutcell.save(path, rig.with_weights(random_weights(rig, 4 + 4 * (turn % 2), seed=turn)))
        sizes.append(path.stat().st_size)
    assert sizes[4] <= sizes[0] + 40
    assert sizes[5] <= sizes[1] + 40


def test_a_weight_too_small_for_float32_takes_no_slot(tmp_path):
    rig = cutcell.load(many_joints().save(tmp_path / "in.glb"))
    weights = np.zeros(rig.weights.shape)
    weights[:, :4] = 0.25
    weights[:, 4] = 1e-50
    cutcell.save(tmp_path / "out.glb", rig.with_weights(weights))
    result = read_document(tmp_path / "out.glb").json["meshes"][0]["primitives"][0]["attributes"]
    assert "JOINTS_1" not in result


def test_rows_without_weight_are_saved_as_such(tmp_path):
    rig = cutcell.load(column().save(tmp_path / "in.glb"))
    weights = rig.weights.copy()
    weights[3] = 0
    cutcell.save(tmp_path / "out.glb", rig.with_weights(weights))
    assert_allclose(cutcell.load(tmp_path / "out.glb").weights, weights, atol=1e-7)


def test_over_the_file_it_came_from(tmp_path):
    path = column().save(tmp_path / "rig.glb")
    check_round_trip(path, tmp_path / "other.glb", 1)
    rig = cutcell.load(path)
    weights = random_weights(rig, 1)
    cutcell.save(path, rig.with_weights(weights))
    assert_allclose(cutcell.load(path).weights, weights)
    assert sorted(os.listdir(tmp_path)) == ["other.glb", "rig.glb"]


def test_other_programs_read_what_was_saved(tmp_path):
    import trimesh

    path = tmp_path / "out.glb"
    rig = cutcell.load(column().save(tmp_path / "in.glb"))
    cutcell.save(path, rig)
    gltf = pygltflib.GLTF2.load_binary(str(path))
    assert gltf.meshes[0].primitives[0].attributes.JOINTS_0 is not None
    scene = trimesh.load(path)
    assert len(scene.to_geometry().faces) == len(FACES)


def test_real_characters(tmp_path, rig_of_each_maker):
    rigs = rig_of_each_maker
    expected = {
        path.stem: errors(report) for path, report in zip(rigs, reports(*rigs), strict=True)
    }
    for most, some in ((4, rigs), (8, rigs[1::3])):
        outs = [tmp_path / path.name for path in some]
        for path, out in zip(some, outs, strict=True):
            check_round_trip(path, out, most)
        for out, report in zip(outs, reports(*outs), strict=True):
            assert errors(report) - expected[out.stem] == {}, out.name
