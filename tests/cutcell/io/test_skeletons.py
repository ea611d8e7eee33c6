"""The skeleton of one file for the mesh of another."""

import json

import numpy as np
import pytest
from numpy.testing import assert_allclose

import cutcell
from cutcell.pose import linear_blend_skinning
from tests.cutcell.io.fbx_builder import binary, column_scene, record
from tests.cutcell.io.gltf.gltf_builder import COLUMN, FACES, REST, Builder, column
from tests.cutcell.io.gltf.test_gltf_clips import animate
from tests.cutcell.io.test_usd import TEXT
from tests.gltf_validator.validator import errors, reports

TURN = [-np.sqrt(0.5), 0, 0, np.sqrt(0.5)]
"""From z up to y up."""


def alone(path, scale=1.0):
    """Write the column as a mesh without a skeleton."""
    if path.suffix == ".glb":
        builder = Builder()
        builder.node(mesh=builder.mesh({"POSITION": builder.positions(COLUMN)}), name="body")
        return builder.save(path)
    lines = [f"v {x} {y} {z}" for x, y, z in scale * COLUMN]
    lines += [f"f {a} {b} {c}" for a, b, c in FACES + 1]
    path.write_text("\n".join(lines))
    return path


def as_json(folder):
    joints = [
        {"name": n, "position": p.tolist()} for n, p in zip(("root", "tip"), REST, strict=True)
    ]
    joints[1]["parent"] = "root"
    (folder / "donor.json").write_text(json.dumps({"joints": joints}))
    return folder / "donor.json"


def as_gltf(folder, end=".glb", builder=None):
    made = (builder or column()).save(folder / f"donor{'.glb' if end == '.vrm' else end}")
    return made.rename(folder / f"donor{end}")


def as_fbx(folder, bones_only=False):
    """Write the column, in centimetres of a scene in metres."""
    scene = column_scene()
    if bones_only:
        head, objects, connections = scene
        parts = ("Model", "NodeAttribute", "Animation")
        keep = [o for o in objects[2] if o[0].startswith(parts) and o[1][0] != 200]
        ids = {0, *(o[1][0] for o in keep)}
        links = [c for c in connections[2] if c[1][1] in ids and c[1][2] in ids]
        scene = [head, record("Objects", children=keep), record("Connections", children=links)]
    (folder / "donor.fbx").write_bytes(binary(scene))
    return folder / "donor.fbx"


def as_moving_gltf(folder):
    """Write the column turning about x within a second."""
    builder = column()
    turns = [[0, 0, 0, 1], [np.sqrt(0.5), 0, 0, np.sqrt(0.5)]]
    animate(builder, (1, "rotation", [0, 1], turns, "LINEAR"))
    return as_gltf(folder, builder=builder)


def as_nodes(folder):
    """Write an armature without any mesh."""
    builder = Builder()
    root = builder.node(name="root", translation=REST[0].tolist())
    tip = builder.node(root, name="tip", translation=[0, 1, 0])
    builder.node(tip, name="tip_end", translation=[0, 1, 0])
    return as_gltf(folder, builder=builder)


def as_saved(folder, end):
    rig = cutcell.load(column().save(folder / "rigged.glb"))
    cutcell.save(folder / f"donor{end}", rig)
    if end == ".txt":
        (folder / "donor.obj").unlink()  # the mesh of the donor is not needed
    return folder / f"donor{end}"


DONORS = {
    "json": as_json,
    "glb": as_gltf,
    "gltf": lambda folder: as_gltf(folder, ".gltf"),
    "vrm": lambda folder: as_gltf(folder, ".vrm"),
    "nodes": as_nodes,
    "fbx": as_fbx,
    "fbx without mesh": lambda folder: as_fbx(folder, bones_only=True),
    "rignet": lambda folder: as_saved(folder, ".txt"),
    "npz": lambda folder: as_saved(folder, ".npz"),
}


@pytest.mark.parametrize("donor", DONORS)
@pytest.mark.parametrize("end", [".obj", ".glb"])
def test_a_mesh_takes_the_skeleton_of_a_file(tmp_path, donor, end):
    rig = cutcell.load(alone(tmp_path / f"body{end}"), DONORS[donor](tmp_path))
    assert rig.skeleton.names[:2] == ("root", "tip")
    assert_allclose(rig.skeleton.joints[:2], REST, atol=1e-6)
    assert rig.skeleton.parents[:2].tolist() == [-1, 0]
    weights = np.zeros((12, len(rig.skeleton.names)))
    weights[:, 1] = 1
    cutcell.save(tmp_path / "out.glb", rig.with_weights(weights))
    assert_allclose(cutcell.load(tmp_path / "out.glb").weights, weights)


def test_a_donor_in_other_units_stands_as_in_its_scene(tmp_path):
    rig = cutcell.load(alone(tmp_path / "body.obj", 0.01), as_fbx(tmp_path))  # metres
    assert_allclose(rig.skeleton.joints[:2], 0.01 * REST, atol=1e-6)
    assert not any("scale" in warning for warning in rig.warnings)


def test_a_donor_that_is_turned_stands_as_in_its_scene(tmp_path):
    builder = column()
    holder = builder.node(rotation=TURN, children=[0])
    builder.json["scenes"][0]["nodes"] = [holder, 2]
    turned = np.array([[1, 0, 0], [0, 0, 1], [0, -1, 0]])
    mesh = alone(tmp_path / "body.obj")
    mesh.write_text(
        "\n".join(
            [f"v {x} {y} {z}" for x, y, z in COLUMN @ turned.T]
            + [f"f {a} {b} {c}" for a, b, c in FACES + 1]
        )
    )
    rig = cutcell.load(mesh, as_gltf(tmp_path, builder=builder))
    assert_allclose(rig.skeleton.joints, REST @ turned.T, atol=1e-6)


@pytest.mark.parametrize("scale", [0.1, 8.0])
def test_joints_that_do_not_fit_are_told(tmp_path, scale):
    rig = cutcell.load(alone(tmp_path / "body.obj", scale), as_json(tmp_path))
    assert sum("donor.json" in warning for warning in rig.warnings) == 1


def test_a_mesh_with_a_skin_takes_no_other_skeleton(tmp_path):
    path = column().save(tmp_path / "in.glb")
    with pytest.raises(cutcell.SkeletonError, match=r"^in\.glb: .* 2 joints"):
        cutcell.load(path, as_json(tmp_path))


def test_plain_nodes_give_way_to_a_skeleton(tmp_path):
    builder = Builder()
    parent = None
    for name in "abc":
        parent = builder.node(parent, name=name, translation=[0.5, 0.5, 0.5])
    builder.node(mesh=builder.mesh({"POSITION": builder.positions(COLUMN)}))
    path = builder.save(tmp_path / "in.glb")
    assert cutcell.load(path).skeleton.names == ("a", "b", "c")
    assert cutcell.load(path, as_json(tmp_path)).skeleton.names == ("root", "tip")


@pytest.mark.parametrize("end", [".glb", ".obj", ".png"])
def test_files_without_joints(tmp_path, end):
    donor = alone(tmp_path / "donor.glb") if end == ".glb" else tmp_path / f"donor{end}"
    donor.touch()
    with pytest.raises((cutcell.SkeletonError, cutcell.FileError), match=rf"^donor\{end}: "):
        cutcell.load(alone(tmp_path / "body.obj"), donor)


def test_usd(tmp_path):
    donor = tmp_path / "donor.usda"
    row = "( (1, 0, 0, 0), (0, 1, 0, 0), (0, 0, 1, 0), (%s, %s, %s, 1) )"
    text = TEXT[: TEXT.index("    def Mesh")] + "}\n"
    donor.write_text(
        text
        % {
            "unit": 1, "up": "Y", "more": "", "up_one": row % (0, 1, 0),
            "root": row % tuple(REST[0]), "tip": row % tuple(REST[1]),
        }
    )  # fmt: skip
    rig = cutcell.load(alone(tmp_path / "body.obj"), donor)
    assert rig.skeleton.names == ("root", "tip")
    assert_allclose(rig.skeleton.joints, REST, atol=1e-6)


MOVING = {"fbx": as_fbx, "fbx without mesh": DONORS["fbx without mesh"], "glb": as_moving_gltf}


@pytest.mark.parametrize(
    ("donor", "end", "scale"),
    [
        *((donor, end, 1.0) for donor in MOVING for end in (".obj", ".glb")),
        ("fbx", ".obj", 0.01),
    ],
)
def test_clips_come_with_a_skeleton(tmp_path, donor, end, scale):
    rig = cutcell.load(alone(tmp_path / f"body{end}", scale), MOVING[donor](tmp_path))
    weights = np.zeros((12, len(rig.skeleton.names)))
    weights[:, 1] = 1
    cutcell.save(tmp_path / "out.glb", rig.with_weights(weights))
    again = cutcell.load(tmp_path / "out.glb")
    quarter = np.array([[1, 0, 0], [0, 0, -1], [0, 1, 0]])
    for one in (rig, again):
        (clip,) = one.clips
        moved = linear_blend_skinning(one.mesh.vertices, weights, clip.sample(clip.duration))
        center = one.skeleton.joints[1]
        assert_allclose(moved, (one.mesh.vertices - center) @ quarter.T + center, atol=1e-5)
    (report,) = reports(tmp_path / "out.glb")
    assert not errors(report)


def test_a_file_of_a_skeleton_alone_names_the_option(tmp_path):
    with pytest.raises(cutcell.FileError, match=r"^donor\.fbx: has no mesh, but .* --skeleton"):
        cutcell.load(as_fbx(tmp_path, bones_only=True))
