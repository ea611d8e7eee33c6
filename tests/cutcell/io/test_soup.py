"""Bare meshes with a skeleton beside them, and files that are nothing we know."""

import json

import numpy as np
import pytest
import trimesh
from numpy.testing import assert_allclose, assert_array_equal

import cutcell
from tests.cutcell.io.gltf.gltf_builder import COLUMN, FACES, REST

ROOT = {"name": "root", "position": [0.5, 0, 0.5], "parent": None}
TIP = {"name": "tip", "position": [0.5, 1, 0.5], "parent": "root"}
HELPER = {"name": "helper", "position": [0, 0, 0], "deform": False}


def write(folder, end=".ply", joints=(ROOT, TIP, HELPER), skeleton="column.json"):
    trimesh.Trimesh(COLUMN, FACES, process=False).export(folder / f"column{end}")
    if joints is not None:
        text = joints if isinstance(joints, str) else json.dumps({"joints": list(joints)})
        (folder / skeleton).write_text(text)
    return folder / f"column{end}"


@pytest.mark.parametrize("end", [".obj", ".ply", ".off"])
@pytest.mark.parametrize("skeleton", ["column.json", "column.skeleton.json"])
def test_meshes_with_shared_vertices_keep_their_order(tmp_path, end, skeleton):
    rig = cutcell.load(write(tmp_path, end, skeleton=skeleton))
    assert_allclose(rig.mesh.vertices, COLUMN)
    assert_array_equal(rig.mesh.faces, FACES)
    assert rig.weights is None
    assert rig.name == "column"
    assert_allclose(rig.skeleton.joints[:2], REST)
    assert rig.skeleton.parents.tolist() == [-1, 0, -1]
    assert rig.skeleton.names == ("root", "tip", "helper")
    assert rig.skeleton.deform.tolist() == [True, True, False]


def test_an_stl_brings_three_vertices_a_triangle(tmp_path):
    rig = cutcell.load(write(tmp_path, ".stl"))
    assert_allclose(rig.mesh.vertices, COLUMN[FACES].reshape(-1, 3))


def test_a_skeleton_elsewhere(tmp_path):
    path = write(tmp_path, joints=None)
    other = tmp_path / "bones.json"
    other.write_text(json.dumps({"joints": [ROOT]}))
    assert cutcell.load(path, skeleton=other).skeleton.names == ("root",)
    with pytest.raises(cutcell.FileError, match=r"gone\.json: there is no such file"):
        cutcell.load(path, skeleton=tmp_path / "gone.json")


def test_a_mesh_on_its_own_says_what_to_write_before_it_is_bound(tmp_path):
    alone = cutcell.load(write(tmp_path, joints=None))
    with pytest.raises(S, match=r"no skeleton; .* put a skeleton beside it") as caught:
        cutcell.bind(alone)
    example = str(caught.value)
    shown = json.loads(example[example.index("{") :])
    assert cutcell.load(write(tmp_path, joints=shown["joints"])).skeleton.names == ("root", "tip")


@pytest.mark.parametrize("end", [".obj", ".ply", ".stl", ".off"])
def test_bound_and_saved_as_glb(tmp_path, end):
    rig = cutcell.load(write(tmp_path, end))
    weights = np.zeros((len(rig.mesh.vertices), 3))
    weights[:, 1] = 1
    cutcell.save(tmp_path / "out.glb", rig.with_weights(weights))
    assert_array_equal(cutcell.load(tmp_path / "out.glb").weights, weights)


F, M, S = cutcell.FileError, cutcell.MeshError, cutcell.SkeletonError


@pytest.mark.parametrize(
    ("joints", "kind", "message"),
    [
        ("{", F, "its JSON cannot be read"),
        ("[1]", F, "is not a skeleton: it must be"),
        ('{"joints": 3}', F, "is not a skeleton: it must be"),
        ([], S, "the skeleton has no joints"),
        ([3], F, "joint 0 must be an object"),
        ([{"position": [0, 0, 0]}], S, 'joint 0 needs a "name"'),
        ([ROOT, ROOT], S, 'the joint "root" is there twice'),
        ([{**ROOT, "pos": 1}], F, 'joint "root": "pos" is none of name, position'),
        ([{**ROOT, "position": [0, 1]}], S, 'joint "root": "position" must be three'),
        ([{**ROOT, "position": [0, 1, "2"]}], S, 'joint "root": "position" must be three'),
        ([{**ROOT, "position": [0, 1, True]}], S, 'joint "root": "position" must be three'),
        ('{"joints": [{"name": "a", "position": [0, 0, NaN]}]}', S, 'joint "a": "position"'),
        ('{"joints": [{"name": "a", "position": [0, 0, 1' + "0" * 400 + "]}]}", S, '"a": "pos'),
        ([TIP], S, "joint \"tip\": its parent 'root' is not a joint"),
        ([{**ROOT, "parent": 0}], S, 'joint "root": its parent 0 is not a joint'),
        ([{**ROOT, "parent": "tip"}, TIP], S, 'a cycle: "root" -> "tip" -> "root"|a cycle: "tip"'),
        ([{**ROOT, "deform": 1}], S, 'joint "root": "deform" must be true or false'),
        ([{**ROOT, "deform": False}], S, "no joint of the skeleton may carry weight"),
    ],
)
def test_errors_name_file_and_joint(tmp_path, joints, kind, message):
    with pytest.raises(kind, match=rf"column\.json: .*{message}"):
        cutcell.load(write(tmp_path, joints=joints))


def test_a_joint_in_other_units(tmp_path):
    far = {**TIP, "position": [0, 900, 0]}
    with pytest.raises(S, match=r'^column\.ply: joint "tip" at .* in the same units'):
        cutcell.load(write(tmp_path, joints=[ROOT, far]))


@pytest.mark.parametrize("end", ["ply", "stl", "off"])
def test_what_is_no_mesh(tmp_path, end):
    (tmp_path / f"a.{end}").write_text("this is a letter, not a mesh")
    with pytest.raises(cutcell.CutcellError, match=rf"^a\.{end}: "):
        cutcell.load(tmp_path / f"a.{end}")


def test_a_cloud_of_points_is_no_mesh(tmp_path):
    trimesh.PointCloud(COLUMN).export(tmp_path / "a.ply")
    with pytest.raises(M, match=r"a\.ply: has no triangles"):
        cutcell.load(tmp_path / "a.ply")


def test_binary_where_text_should_be(tmp_path):
    (tmp_path / "a.obj").write_bytes(b"v \xff\xfe")
    with pytest.raises(F, match=r"a\.obj: is not a text file \(byte 2 is not UTF-8\)"):
        cutcell.load(tmp_path / "a.obj")


@pytest.mark.parametrize("end", [".glb", ".gltf", ".npz", ".txt", ".obj", ".ply", ".fbx", ""])
def test_missing_empty_or_a_folder(tmp_path, end):
    with pytest.raises(F, match=rf"gone{end}: there is no such file"):
        cutcell.load(tmp_path / f"gone{end}")
    (tmp_path / f"empty{end}").touch()
    with pytest.raises(F, match=rf"empty{end}: the file is empty"):
        cutcell.load(tmp_path / f"empty{end}")
    (tmp_path / f"folder{end}").mkdir()
    with pytest.raises(F, match=rf"folder{end}: is a folder"):
        cutcell.load(tmp_path / f"folder{end}")


def test_other_kinds_of_files(tmp_path):
    (tmp_path / "a.blend").write_bytes(b"BLENDER-v300")
    with pytest.raises(F, match=r'a\.blend: "\.blend" cannot be read; give \.npz'):
        cutcell.load(tmp_path / "a.blend")
    (tmp_path / "a.ma").write_text("//Maya ASCII 2020 scene")
    with pytest.raises(F, match="from Maya: export as FBX"):
        cutcell.load(tmp_path / "a.ma")
    (tmp_path / "a.json").write_text("{}")
    with pytest.raises(F, match=r"a\.json: is not a mesh; give the mesh"):
        cutcell.load(tmp_path / "a.json")


def test_saving_needs_a_known_ending_and_a_folder(tmp_path):
    rig = cutcell.load(write(tmp_path))
    with pytest.raises(F, match=r'out\.ply: a rig cannot be saved as "\.ply"; end the name in'):
        cutcell.save(tmp_path / "out.ply", rig)
    with pytest.raises(F, match=r"out\.glb: there is no folder .*nowhere"):
        cutcell.save(tmp_path / "nowhere" / "out.glb", rig)


@pytest.mark.parametrize("newline", ["\n", "\r\n"])
def test_lines_of_an_obj_go_on_after_a_backslash(tmp_path, newline):
    lines = ["# of C:\\models\\", "v 0 0 \\", "  0", "v 1 0 0", "v 0 1 0", "v 0 0 1", "f 1 \\"]
    lines += ["\\", "3 2", "f 1 2 3 \\", "4 \\"]
    (tmp_path / "a.obj").write_bytes(newline.join(lines).encode())
    mesh = cutcell.load(tmp_path / "a.obj").mesh
    assert mesh.vertices.tolist() == [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]]
    assert len(mesh.faces) == 3


def test_an_error_names_the_line_where_it_begins(tmp_path):
    (tmp_path / "a.obj").write_text("v 0 0 0\nf 1 \\\n  2 9\n")
    with pytest.raises(cutcell.CutcellError, match=r"^a\.obj: line 2: vertex"):
        cutcell.load(tmp_path / "a.obj")
