"""Rigs that a format cannot hold as they are: a sentence, or what is told to stand for it."""

import json
from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

import cutcell
from cutcell.io import check_output
from cutcell.io.files import whole_characters
from tests.cutcell.io.gltf.gltf_builder import COLUMN, FACES, REST, column
from tests.cutcell.io.gltf.test_gltf_fresh import check_valid, small_rig

HALF = "a\ud800b"
HIGH, LOW = "\ud83d", "\ude00"


def sized(scale, offset=0.0):
    """Return the column at another size and place."""
    rig = small_rig()
    joints = rig.skeleton.joints * scale + offset
    skeleton = cutcell.Skeleton(joints, rig.skeleton.parents, rig.skeleton.names)
    mesh = cutcell.TriangleMesh(rig.mesh.vertices * scale + offset, rig.mesh.faces)
    return cutcell.Rig(mesh, skeleton, rig.weights)


@pytest.mark.parametrize(
    ("scale", "offset"), [(1e300, 0), (1.7e38, 1e38), (1e-44, 0), (1e-300, 0), (1, 100000.003)]
)
@pytest.mark.parametrize("end", [".glb", ".gltf"])
def test_what_32_bits_cannot_hold_is_refused_and_saved_elsewhere(tmp_path, scale, offset, end):
    rig = sized(scale, offset)
    with pytest.raises(
        (cutcell.MeshError, cutcell.SkeletonError),
        match=r"^out\.\w+: glTF's numbers have 32 bits: its (mesh|skeleton) at \(.*\) would move "
        "by more than a thousandth of the mesh's size; scale it or move it",
    ):
        cutcell.save(tmp_path / f"out{end}", rig)
    assert not list(tmp_path.iterdir())
    for name in ("out.npz", "out.txt"):
        cutcell.save(tmp_path / name, rig)
        again = cutcell.load(tmp_path / name)
        assert_array_equal(again.mesh.vertices, rig.mesh.vertices)
        assert_array_equal(again.skeleton.joints, rig.skeleton.joints)


@pytest.mark.parametrize(("scale", "offset"), [(1e37, 0), (1e-37, 0), (1, 1e3), (1, -999)])
def test_what_32_bits_hold_is_saved(tmp_path, scale, offset):
    rig = sized(scale, offset)
    cutcell.save(tmp_path / "out.glb", rig)
    again = cutcell.load(tmp_path / "out.glb")
    assert_allclose(again.mesh.vertices / scale, rig.mesh.vertices / scale, atol=1e-3)
    assert_allclose(again.skeleton.joints / scale, rig.skeleton.joints / scale, atol=1e-3)


def test_a_joint_or_an_attachment_far_away_is_named(tmp_path):
    rig = small_rig()
    far = cutcell.Skeleton([*REST, [0, 1e39, 0]], [-1, 0, 0], deform=[True, True, False])
    weights = np.pad(rig.weights, ((0, 0), (0, 1)))
    with pytest.raises(cutcell.SkeletonError, match=r"its skeleton at \(0, 1e\+39, 0\) would move"):
        cutcell.save(tmp_path / "out.glb", cutcell.Rig(rig.mesh, far, weights))
    mesh = cutcell.TriangleMesh(COLUMN.astype(float) * 1e39, FACES)
    sword = cutcell.Attachment("sword", mesh, 1)
    with pytest.raises(cutcell.MeshError, match='the attachment "sword" at'):
        cutcell.save(tmp_path / "out.glb", replace(rig, attachments=(sword,)))


def test_more_joints_than_gltf_can_number_are_refused(tmp_path, monkeypatch):
    monkeypatch.setattr("cutcell.io.gltf.write.new.MAX_GLTF_JOINTS", 1)
    with pytest.raises(cutcell.SkeletonError, match="at most 1 joints, and the skeleton has 2"):
        cutcell.save(tmp_path / "out.glb", small_rig())


def test_what_cannot_be_saved_is_told_before_the_work(tmp_path):
    for name, rig in (("a.glb", sized(1e300)), ("a.vrm", small_rig())):
        with pytest.raises(cutcell.CutcellError, match=r"32 bits|no VRM"):
            check_output(tmp_path / name, rig)
        check_output(tmp_path / name)
    assert not any(tmp_path.iterdir())


@pytest.mark.parametrize(
    ("text", "whole"),
    [
        (HALF, "a�b"),
        (HIGH + LOW, "😀"),
        (LOW + HIGH, "��"),
        ("plain", "plain"),
        ("骨\0é😀", "骨\0é😀"),
        ("", ""),
    ],
)
def test_halves_of_characters_are_replaced(text, whole):
    assert whole_characters(text) == whole
    whole_characters(text).encode()


def half_named(path):
    """Write the column with halves of characters in the names of a joint and of the mesh."""
    builder = column()
    builder.json["nodes"][0]["name"] = HALF
    builder.json["meshes"][0]["name"] = HALF
    builder.json["extras"] = {"whole": HIGH + LOW, HALF: [HALF, 1.5]}
    return builder.save(path)


def test_halves_in_the_names_of_a_file_are_replaced_and_told(tmp_path):
    rig = cutcell.load(half_named(tmp_path / "in.glb"))
    assert rig.skeleton.names == ("a�b", "tip")
    assert rig.warnings == (
        "a name in it holds half of a character (a lone surrogate), for which � stands",
    )
    cutcell.save(tmp_path / "out.glb", rig)
    again = cutcell.load(tmp_path / "out.glb")
    assert again.warnings == ()
    assert again.source.document.json["extras"] == {"whole": "😀", "a�b": ["a�b", 1.5]}


def test_whole_characters_beyond_the_first_plane_are_nothing_to_tell(tmp_path):
    builder = column()
    builder.json["nodes"][0]["name"] = "😀"  # two escapes in the file
    rig = cutcell.load(builder.save(tmp_path / "in.glb"))
    assert rig.skeleton.names[0] == "😀"
    assert rig.warnings == ()


@pytest.mark.parametrize("end", [".glb", ".txt", ".npz"])
def test_halves_in_the_names_of_a_rig_are_saved_as_whole(tmp_path, end):
    rig = small_rig(name=HALF)
    skeleton = cutcell.Skeleton(REST, [-1, 0], (HALF, HIGH + LOW))
    clip = cutcell.Clip(HALF, np.zeros(1), np.eye(4)[None, None].repeat(2, axis=1))
    sword = cutcell.Attachment(HALF, rig.mesh, 1)
    rig = replace(rig, skeleton=skeleton, clips=(clip,), attachments=(sword,))
    path = tmp_path / f"out{end}"
    cutcell.save(path, rig)
    again = cutcell.load(path)
    assert again.skeleton.names == ("a�b", "😀")
    assert not any("surrogate" in warning for warning in again.warnings)
    assert_allclose(again.weights, rig.weights, atol=1e-7)
    if end == ".glb":
        check_valid(path)
        assert again.clips[0].name == again.attachments[0].name == "a�b"


def test_halves_in_an_archive_are_told(tmp_path):
    cutcell.save(tmp_path / "in.npz", small_rig())
    with np.load(tmp_path / "in.npz") as stored:
        arrays = dict(stored)
    np.savez(tmp_path / "in.npz", **arrays | {"joint_names": np.array([HALF, "tip"])})
    rig = cutcell.load(tmp_path / "in.npz")
    assert rig.skeleton.names == ("a�b", "tip")
    assert len(rig.warnings) == 1


def test_a_skeleton_with_halves_is_refused(tmp_path):
    cutcell.save(tmp_path / "a.txt", small_rig())
    (tmp_path / "a.txt").unlink()
    joints = [{"name": "root", "position": [0, 0, 0]}, {"name": HALF, "position": [0, 1, 0]}]
    (tmp_path / "a.json").write_text(json.dumps({"joints": joints}))
    with pytest.raises(cutcell.SkeletonError, match="the name of joint 1 holds half of a char"):
        cutcell.load(tmp_path / "a.obj")


def test_an_avatar_stays_one(tmp_path):
    builder = column()
    builder.json["extensionsUsed"] = ["VRMC_vrm"]
    humanoid = {"specVersion": "1.0", "humanoid": {"humanBones": {"hips": {"node": 0}}}}
    builder.json["extensions"] = {"VRMC_vrm": humanoid}
    (tmp_path / "in.vrm").write_bytes(builder.glb())
    rig = cutcell.load(tmp_path / "in.vrm")
    assert cutcell.save(tmp_path / "out.vrm", rig) == (tmp_path / "out.vrm",)
    again = cutcell.load(tmp_path / "out.vrm")
    assert (tmp_path / "out.vrm").read_bytes()[:4] == b"glTF"
    assert again.source.document.json["extensions"] == {"VRMC_vrm": humanoid}
    assert_allclose(again.weights, rig.weights)


@pytest.mark.parametrize("extensions", [None, 5, [], {}, {"KHR_lights_punctual": {}}])
def test_what_is_no_avatar_is_not_saved_as_one(tmp_path, extensions):
    builder = column()
    if extensions is not None:
        builder.json["extensions"] = extensions
    stored = cutcell.load(builder.save(tmp_path / "in.glb"))
    for rig in (stored, small_rig()):
        with pytest.raises(cutcell.FileError, match=r"^new\.vrm: .*\.glb"):
            cutcell.save(tmp_path / "new.vrm", rig)
        with pytest.raises(cutcell.FileError, match=r"^new\.vrm: .*\.glb"):
            check_output(tmp_path / "new.vrm", rig)
    assert not (tmp_path / "new.vrm").exists()
