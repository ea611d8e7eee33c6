"""What is bound and saved is the same when it is loaded again, in every format."""

import json
from dataclasses import replace

import numpy as np
import pytest

import cutcell
from benchmarks import round_trip
from cutcell import Clip
from cutcell.io.formats import suffixes
from cutcell.pose import swing
from tests.benchmarks.markdown import read_tables
from tests.cutcell.cli.files import JOINTS, write_obj
from tests.cutcell.io.fbx_builder import binary, column_scene, vector, with_materials
from tests.cutcell.io.gltf.gltf_builder import REST, column, two_skins
from tests.cutcell.io.gltf.test_gltf_clips import LINEAR, animate
from tests.cutcell.io.gltf.test_gltf_fresh import small_rig
from tests.cutcell.io.gltf.test_gltf_layouts import Layout
from tests.cutcell.io.gltf.test_gltf_save import interleaved, many_joints, sparse_weights
from tests.cutcell.io.gltf.test_vrm import VRM1, avatar
from tests.cutcell.io.materials.test_gltf_colored import HALVES, IN_FILE, INSIDE, SKIN_PNG
from tests.cutcell.io.materials.test_obj_materials import RED, SKIN, lines
from tests.cutcell.io.test_usd import text as usd_text


def shared_views(path):
    """Write three meshes whose arrays lie in one view for each type."""
    layout = Layout(lambda name: "shared")
    for k in range(3):
        layout.mesh(k)
    layout.extras()
    return layout.save(path)


def moving(path):
    builder = column()
    animate(builder, *LINEAR)
    return builder.save(path)


def bare(path):
    return write_obj(path, joints=JOINTS)


def coloured(path):
    joints = [{**joint, "position": list(rest)} for joint, rest in zip(JOINTS, REST, strict=True)]
    path.with_suffix(".json").write_text(json.dumps({"joints": joints}, default=float))
    path.with_suffix(".mtl").write_text(RED + SKIN)
    path.with_name("skin.png").write_bytes(SKIN_PNG)
    path.write_text(lines("red", "skin", library="mtllib coloured.mtl"))
    return path


def coloured_fbx(path):
    looks = [([vector("DiffuseColor", (1, 0, 0))], None), ([], INSIDE)]
    scene = with_materials(column_scene(), IN_FILE, polygons=HALVES, materials=looks)
    path.write_bytes(binary(scene))
    return path


def rignet(path):
    cutcell.save(path, small_rig())
    return path


FILES = {
    "shared.gltf": shared_views,
    "interleaved.glb": lambda path: interleaved().save(path),
    "sparse.glb": lambda path: sparse_weights().save(path),
    "skins.gltf": lambda path: two_skins([3, 0, -2]).save(path),
    "joints.glb": lambda path: many_joints().save(path),
    "moving.glb": moving,
    "avatar.vrm": lambda path: avatar(VRM1).save(path.with_suffix(".glb")).rename(path),
    "bare.obj": bare,
    "rignet.txt": rignet,
    "archive.npz": rignet,
    "coloured.obj": coloured,
    "coloured.fbx": coloured_fbx,
    "film.fbx": lambda path: path.write_bytes(binary(column_scene())) and path,
    "stage.usda": lambda path: path.write_text(usd_text()) and path,
}


@pytest.mark.nightly
@pytest.mark.parametrize("name", FILES)
def test_every_format_gives_back_what_was_saved(tmp_path, name, capsys):
    path = FILES[name](tmp_path / name)
    before = {file: file.read_bytes() for file in tmp_path.iterdir()}
    assert round_trip.main([str(path), "--resolution", "8"]) == 0
    (rows,) = read_tables(capsys.readouterr().out).values()
    expected = {kind[1:]: "equal" for kind in suffixes("write")}
    if path.suffix != ".vrm":
        expected["vrm"] = "-"
    if name == "sparse.glb":  # its two views more are empty shells now: numbers never change
        reports = "equal (2 information UNUSED_OBJECT)"
        expected |= {"glb": reports, "gltf": reports}
    if name == "coloured.obj":  # its texture coordinates are kept, though it has no image
        unused = "equal (1 information UNUSED_OBJECT)"
        expected |= {"glb": unused, "gltf": unused}
    if path.suffix in (".fbx", ".usda"):  # no document to compare with: of how it was made
        rows[0] = {key: cell.partition(" (")[0] for key, cell in rows[0].items()}
    assert rows == [{"file": path.stem, **expected}]
    assert {file: file.read_bytes() for file in tmp_path.iterdir()} == before


def test_a_file_that_cannot_be_loaded_is_told(tmp_path, capsys):
    (tmp_path / "bad.glb").write_text("no such thing")
    round_trip.main([str(tmp_path / "bad.glb"), "--resolution", "8"])
    assert "not loaded: bad.glb: is not a glTF file" in capsys.readouterr().out


def moved(rig):
    mesh = cutcell.TriangleMesh(rig.mesh.vertices + 1e-3, rig.mesh.faces)
    return replace(rig, mesh=mesh)


def renamed(rig):
    return replace(rig, skeleton=replace(rig.skeleton, names=("root", "other")))


def other_deform(rig):
    return replace(rig, skeleton=replace(rig.skeleton, deform=[True, False]))


def turned(rig):
    axes = np.tile(np.diag([1.0, -1, -1]), (2, 1, 1))
    return replace(rig, skeleton=replace(rig.skeleton, orientations=axes))


def slower(rig):
    clip = rig.clips[0]
    return replace(rig, clips=(Clip(clip.name, clip.times * 1.01, clip.transforms),))


@pytest.mark.parametrize(
    ("change", "told"),
    [
        (moved, "vertices"),
        (renamed, "names and parents"),
        (slower, "clips"),
        (lambda rig: replace(rig, clips=()), "clips"),
        (lambda rig: replace(rig, attachments=()), "attachments"),
        (lambda rig: replace(rig, world=np.diag([1, 1, 2, 1.0])), "place in the scene"),
        (lambda rig: rig.with_weights(rig.weights[:, ::-1]), "weights"),
        (lambda rig: rig.with_weights(None), "weights"),
        (turned, "orientations"),
        (other_deform, "joints that deform"),
    ],
)
def test_what_differs_is_told(change, told):
    rig = small_rig()
    sword = cutcell.Attachment("sword", rig.mesh, 1)
    axes = np.tile(np.eye(3), (2, 1, 1))
    rig = replace(rig, skeleton=replace(rig.skeleton, orientations=axes))
    rig = replace(rig, clips=(swing(rig.skeleton, 1, "z", 30),), attachments=(sword,))
    assert list(round_trip.differences(rig, rig, ".glb")) == []
    assert list(round_trip.differences(rig, change(rig), ".glb")) == [told]


def test_data_of_the_document_that_differs_is_told(tmp_path):
    layout = Layout()
    primitive = layout.mesh(0)
    layout.extras()
    rig = cutcell.load(layout.save(tmp_path / "a.gltf"))
    document = layout.finished()
    normal = document["accessors"][primitive["attributes"]["NORMAL"]]
    normal["bufferView"] = document["accessors"][primitive["attributes"]["POSITION"]]["bufferView"]
    document["images"][0]["bufferView"] = normal["bufferView"]
    (tmp_path / "b.gltf").write_text(json.dumps(document))
    other = cutcell.load(tmp_path / "b.gltf")
    reports = list(round_trip.differences(rig, other, ".gltf"))
    assert reports == [f"accessor {primitive['attributes']['NORMAL']}", "images"]


def test_all_files_at_hand_are_tried():
    names = {path.name for path in round_trip.files()}
    assert {"biped.glb", "robot.glb"} <= names
