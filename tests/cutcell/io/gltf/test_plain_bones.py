"""Skeletons that are plain nodes, and meshes without a skin in a skinned document."""

import copy

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

import cutcell
from cutcell.io.gltf.nodes import Nodes
from tests.cutcell.io.gltf.gltf_builder import COLUMN, Builder, column
from tests.cutcell.io.gltf.test_vrm import VRM0, VRM1
from tests.gltf_validator.validator import errors, reports

PLACE = {"translation": [2, 0, 0], "scale": [2, 1, 1], "rotation": [0, 0.6, 0, 0.8]}
POSES = [[2.5, 0.1, 0], [0, 0.9, 0], [0, 0.9, 0]]


def bones(builder, parent=None, names=("a", "b", "c"), places=POSES):
    """Add a chain of empty nodes; return their numbers."""
    made = []
    for name, place in zip(names, places, strict=True):
        parent = builder.node(parent, translation=place, **({"name": name} if name else {}))
        made.append(parent)
    return made


def body(builder, parent=None, name="body", **fields):
    mesh = builder.mesh({"POSITION": builder.positions(COLUMN)}, name=name)
    return builder.node(parent, mesh=mesh, name=name, **fields)


def unbound(**place):
    """Return a body and an armature of three bones beside it."""
    builder = Builder()
    armature = builder.node(name="Armature", translation=[0, -1, 0])
    bones(builder, armature, places=[[2.5, 1.1, 0], *POSES[1:]])
    body(builder, **(place or PLACE))
    return builder


def scene_points(path):
    """Return the vertices of the first mesh as a viewer shows them, with its skin at rest."""
    rig = cutcell.load(path)
    world = rig.world
    return rig.mesh.vertices @ world[:3, :3].T + world[:3, 3]


def weighted(rig):
    """Return a rig with weights that differ from vertex to vertex."""
    share = np.linspace(0, 1, len(rig.mesh.vertices))
    weights = np.zeros((len(share), len(rig.skeleton.joints)))
    weights[:, 0], weights[:, -1] = share, 1 - share
    return rig.with_weights(weights)


def test_chains_of_nodes_are_joints(loaded):
    rig = loaded(unbound())
    names = rig.skeleton.names
    assert set(names) == {"Armature", "a", "b", "c"}
    parents = {
        n: names[p] if p >= 0 else "" for n, p in zip(names, rig.skeleton.parents, strict=True)
    }
    assert parents == {"Armature": "", "a": "Armature", "b": "a", "c": "b"}
    places = dict(zip(names, rig.skeleton.joints.tolist(), strict=True))
    assert_allclose([places[n] for n in "abc"], np.cumsum(POSES, axis=0), atol=1e-6)
    assert rig.weights is None
    assert [part.name for part in rig.parts] == ["body"]


@pytest.mark.parametrize("end", [".glb", ".gltf"])
def test_it_is_saved_with_a_skin_and_all_else(loaded, tmp_path, end):
    builder = unbound()
    builder.add("cameras", {"type": "perspective", "perspective": {"yfov": 1, "znear": 1}})
    builder.node(name="eye", camera=0)
    builder.json["nodes"][1]["extras"] = {"color": "red"}
    before = loaded(builder, f"in{end}")
    rig = weighted(before)
    cutcell.save(tmp_path / f"out{end}", rig)
    again = cutcell.load(tmp_path / f"out{end}")
    order = [again.skeleton.names.index(name) for name in rig.skeleton.names]
    assert_allclose(again.weights[:, order], rig.weights, atol=1e-7)
    assert_allclose(scene_points(tmp_path / f"out{end}"), before.mesh.vertices, atol=1e-5)
    saved = again.source.document.json
    nodes = copy.deepcopy(saved["nodes"])
    assert nodes[4].pop("skin") == 0
    assert nodes == builder.json["nodes"]
    assert saved["cameras"] == builder.json["cameras"]
    # Every joint at rest leads its inverse bind matrix to the mesh's place.
    tree = Nodes(again.source.document)
    at_rest = tree.world[again.source.nodes] @ again.source.inverse
    assert_allclose(at_rest, np.tile(again.world, (4, 1, 1)), atol=1e-5)
    (report,) = reports(tmp_path / f"out{end}")
    assert not errors(report)


def test_the_second_of_two_meshes_and_instances_stay_in_place(loaded, tmp_path):
    builder = unbound(translation=[2, 0, 0])
    builder.node(mesh=0, name="instance", translation=[2, 1, 0], scale=[-1, 1, 1])
    rig = loaded(builder)
    assert [part.name for part in rig.parts] == ["body", "instance"]
    assert_allclose(rig.mesh.vertices[:12], COLUMN + np.array([2, 0, 0]), atol=1e-6)
    assert_allclose(rig.mesh.vertices[12:], COLUMN * [-1, 1, 1] + [2, 1, 0], atol=1e-6)
    cutcell.save(tmp_path / "out.glb", weighted(rig))
    assert_allclose(scene_points(tmp_path / "out.glb"), rig.mesh.vertices, atol=1e-5)
    again = cutcell.load(tmp_path / "out.glb")
    order = [again.skeleton.names.index(name) for name in rig.skeleton.names]
    assert_allclose(again.weights[:, order], weighted(rig).weights, atol=1e-7)


@pytest.mark.parametrize("extensions", [VRM0, VRM1], ids=["0", "1"])
def test_the_bones_of_an_avatar_are_its_humanoid(loaded, tmp_path, extensions):
    builder = Builder()
    root = builder.node(name="root")
    hips, spine, _ = bones(builder, root, (None, "B", "hair"), [[0.5, 0, 0.5], *POSES[1:]])
    body(builder, root)
    humanoid = copy.deepcopy(extensions)
    key = next(iter(humanoid))
    humanoid[key]["humanoid"]["humanBones"] = (
        [{"bone": "hips", "node": hips}, {"bone": "spine", "node": spine}]
        if key == "VRM"
        else {"hips": {"node": hips}, "spine": {"node": spine}}
    )
    builder.json["extensions"] = humanoid
    builder.save(tmp_path / "a.glb").rename(tmp_path / "a.vrm")
    rig = cutcell.load(tmp_path / "a.vrm")
    assert rig.skeleton.names == ("hips", "B", "hair")  # the node has a name, or the humanoid
    cutcell.save(tmp_path / "out.vrm", weighted(rig))
    saved = cutcell.load(tmp_path / "out.vrm")
    assert_allclose(saved.weights, weighted(rig).weights, atol=1e-7)
    assert saved.source.document.json["extensions"] == humanoid


def test_a_mesh_on_a_bone_is_an_accessory(loaded):
    builder = unbound(translation=[2, 0, 0])
    body(builder, 2, "sword", scale=[0.1, 0.1, 0.1])
    rig = loaded(builder)
    assert [one.name for one in rig.attachments] == ["sword"]
    assert [part.name for part in rig.parts] == ["body"]
    assert any("sword" in warning for warning in rig.warnings)


def test_meshes_that_all_hang_on_bones_are_bound(loaded):
    builder = Builder()
    armature = builder.node(name="Armature")
    a, b, _ = bones(builder, armature, places=[[0.5, 0, 0.5], *POSES[1:]])
    body(builder, a, "lower")
    body(builder, b, "upper")
    rig = loaded(builder)
    assert [part.name for part in rig.parts] == ["lower", "upper"]
    assert rig.attachments == ()
    assert len(rig.skeleton.joints) >= 3
    assert_allclose(rig.mesh.vertices[12:], COLUMN + np.array([0.5, 0.9, 0.5]), atol=1e-6)


def groups():
    """Return meshes in groups of groups."""
    builder = Builder()
    group = builder.node(builder.node(builder.node(name="scene"), name="city"), name="house")
    body(builder, group)
    return builder


def helpers():
    """Return a mesh with a lamp and a camera that were exported as empty nodes."""
    builder = Builder()
    body(builder)
    builder.node(builder.node(name="Light", translation=[0, 1, 0]), name="Light_Orientation")
    return builder


def star():
    """Return a mesh with empty nodes that mark places on it."""
    builder = Builder()
    group = builder.node(name="places")
    for x in (0.2, 0.5, 0.8):
        builder.node(group, translation=[x, 1, 0.5])
    body(builder)
    return builder


@pytest.mark.parametrize("make", [groups, helpers, star])
def test_empty_nodes_that_are_no_bones(loaded, make):
    rig = loaded(make())
    assert len(rig.skeleton.joints) == 0
    assert rig.warnings == ()


def far():
    builder = unbound(translation=[500, 0, 0])
    return builder


def rigid():
    builder = Builder()
    node = body(builder)
    times, places = builder.accessor([0.0, 1.0]), builder.accessor(np.eye(3)[:2])
    builder.add("animations", {
        "channels": [{"sampler": 0, "target": {"node": node, "path": "translation"}}],
        "samplers": [{"input": times, "output": places}],
    })  # fmt: skip
    return builder


def morphed():
    builder = rigid()
    primitive = builder.json["meshes"][0]["primitives"][0]
    primitive["targets"] = [{"POSITION": primitive["attributes"]["POSITION"]}]
    builder.json["animations"][0]["channels"][0]["target"]["path"] = "weights"
    builder.json["animations"][0]["samplers"][0]["output"] = builder.accessor([0.0, 1.0])
    return builder


@pytest.mark.parametrize(
    ("make", "word"), [(far, "outside"), (rigid, "rigidly"), (morphed, "morph")]
)
def test_why_a_file_has_no_joints(loaded, make, word):
    rig = loaded(make())
    assert len(rig.skeleton.joints) == 0
    with pytest.raises(cutcell.SkeletonError, match=word):
        cutcell.bind(rig)
    assert len(rig.warnings) == 1 + (word == "morph")  # which are not read, either


def with_accessories():
    """Return the column with a sword on the tip, a crown beside it, a mesh in another scene."""
    builder = column()
    body(builder, 1, "sword", translation=[1, 0, 0], rotation=[0, 0.6, 0, 0.8])
    body(builder, None, "crown", translation=[0, 2, 0])
    builder.json["scenes"].append({"nodes": [], "name": "other"})
    elsewhere = body(builder, None, "elsewhere")
    builder.json["scenes"][1]["nodes"].append(builder.json["scenes"][0]["nodes"].pop())
    assert elsewhere == builder.json["scenes"][1]["nodes"][0]
    return builder


def test_what_is_left_out_is_listed(loaded):
    rig = loaded(with_accessories())
    for name in ("sword", "crown", "elsewhere"):
        assert sum(name in warning for warning in rig.warnings) == 1
    assert len(rig.mesh.vertices) == 12


def test_accessories_are_bound_when_asked_for(tmp_path):
    path = with_accessories().save(tmp_path / "in.glb")
    plain, rig = cutcell.load(path), cutcell.load(path, accessories=True)
    assert [part.name for part in rig.parts] == ["body", "sword", "crown"]
    assert rig.attachments == ()
    (sword,) = plain.attachments
    assert_allclose(rig.mesh.vertices[12:24], sword.mesh.vertices, atol=1e-6)
    assert_allclose(rig.mesh.vertices[24:], COLUMN + np.array([0, 2, 0]), atol=1e-6)
    assert_array_equal(rig.weights[:12], plain.weights)
    assert_array_equal(rig.weights[12:24], np.tile([0, 1], (12, 1)))  # as the file moves it
    assert rig.allowed is None
    cutcell.save(tmp_path / "out.glb", weighted(rig))
    again = cutcell.load(tmp_path / "out.glb")
    assert_allclose(again.weights, weighted(rig).weights, atol=1e-7)
    assert_allclose(again.mesh.vertices, rig.mesh.vertices, atol=1e-5)
    (report,) = reports(tmp_path / "out.glb")
    assert not errors(report)


def test_a_second_place_of_a_skinned_mesh_is_an_accessory(loaded, tmp_path):
    builder = column()
    builder.node(1, mesh=0, name="again", translation=[3, 0, 0])
    path = builder.save(tmp_path / "in.glb")
    rig = cutcell.load(path, accessories=True)
    assert [part.name for part in rig.parts] == ["body", "again"]
    cutcell.save(tmp_path / "out.glb", weighted(rig))
    assert_allclose(cutcell.load(tmp_path / "out.glb").weights, weighted(rig).weights, atol=1e-7)
