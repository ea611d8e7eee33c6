"""FBX of every age, as text and binary: the column comes out, whatever way it was written."""

import sys

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

import cutcell
from cutcell.io import keeps_document
from cutcell.pose import linear_blend_skinning
from tests.cutcell.io.fbx_builder import (
    MESH,
    binary,
    column_scene,
    layer,
    model,
    old_text,
    prop,
    record,
    text,
    vector,
)
from tests.cutcell.io.gltf.gltf_builder import COLUMN, FACES, REST, SHARES
from tests.gltf_validator.validator import errors, reports

WAYS = {
    "text 7.4": text(column_scene()),
    "binary 7.4": binary(column_scene()),
    "binary 7.5": binary(column_scene(), 7500),
    "text 6.1": old_text(),
}
QUARTER = np.array([[1, 0, 0], [0, 0, -1], [0, 1, 0]])
"""About x: y becomes z."""


@pytest.fixture
def load(tmp_path):
    def loaded(data, name="column.fbx"):
        (tmp_path / name).write_bytes(data)
        return cutcell.load(tmp_path / name)

    return loaded


def check(rig):
    assert_allclose(rig.mesh.vertices, COLUMN, atol=1e-6)
    assert_array_equal(rig.mesh.faces, FACES)
    assert_allclose(rig.skeleton.joints[:2], REST, atol=1e-6)
    assert_allclose(rig.weights[:, :2], SHARES[:, :2], atol=1e-6)
    assert rig.skeleton.parents[:2].tolist() == [-1, 0]
    assert rig.skeleton.names[:2] == ("root", "tip")
    assert [part.name for part in rig.parts] == ["body"]


@pytest.mark.parametrize("way", WAYS)
def test_every_way_of_writing_gives_the_same_rig(load, way):
    rig = load(WAYS[way])
    check(rig)
    assert_allclose(rig.world, np.diag([0.01, 0.01, 0.01, 1]), atol=1e-9)
    assert len(rig.warnings) == 1
    assert rig.warnings[0].startswith("of an FBX, the meshes, skeleton, weights and clips are read")


def test_bones_without_weights_are_joints_too(load):
    rig = load(WAYS["binary 7.4"])
    assert rig.skeleton.names == ("root", "tip", "tip_end")
    assert_allclose(rig.skeleton.joints[2], [0.5, 1.5, 0.5], atol=1e-6)
    assert rig.skeleton.deform.tolist() == [True, True, False]
    assert_allclose(rig.skeleton.orientations, np.tile(np.eye(3), (3, 1, 1)), atol=1e-6)


class TestTransforms:
    def test_units_and_the_axis_that_is_up_lead_to_the_scene(self, load):
        rig = load(text(column_scene(up=2, unit=100.0)))
        check(rig)
        x, y, z = COLUMN.T
        scene = COLUMN @ rig.world[:3, :3].T + rig.world[:3, 3]
        assert_allclose(scene, np.stack([x, z, -y], axis=1), atol=1e-6)

    def test_a_clip_turns_the_joint(self, load):
        rig = load(WAYS["text 7.4"])
        (clip,) = rig.clips
        assert clip.name == "bow"
        assert clip.duration == pytest.approx(1)
        half = np.argmin(np.abs(clip.times - 0.5))
        assert clip.transforms[half][1, 1, 1] == pytest.approx(np.sqrt(0.5), abs=0.04)
        assert_allclose(clip.transforms[-1][1, :3, :3], QUARTER, atol=1e-6)
        moved = linear_blend_skinning(rig.mesh.vertices, rig.weights, clip.transforms[-1])
        assert_allclose(moved[:4], COLUMN[:4], atol=1e-6)
        assert_allclose(moved[8:], (COLUMN[8:] - REST[1]) @ QUARTER.T + REST[1], atol=1e-6)

    def test_rotation_before_and_after_the_turn(self, load):
        turns = [
            vector("PreRotation", (0, 0, 90)),
            vector("PostRotation", (0, 0, 90)),
            prop("RotationActive", 1, kind="bool"),
        ]
        rig = load(text(column_scene(joint=turns)))
        check(rig)
        # Rz(90) Rx(90) Rz(-90): the turn about x became one about y.
        about_y = np.array([[0, 0, 1], [0, 1, 0], [-1, 0, 0]])
        assert_allclose(rig.clips[0].transforms[-1][1, :3, :3], about_y, atol=1e-6)
        assert_allclose(rig.clips[0].transforms[0][1], np.eye(4), atol=1e-6)

    def test_a_mesh_moved_within_its_node_stands_off_its_joints(self, load):
        offset = np.array([0, 0, 5])
        rig = load(text(column_scene(node=[vector("GeometricTranslation", offset)])))
        assert_allclose(rig.mesh.vertices, COLUMN, atol=1e-6)
        assert_allclose(rig.skeleton.joints[:2], REST - offset, atol=1e-6)
        scene = COLUMN @ rig.world[:3, :3].T + rig.world[:3, 3]
        assert_allclose(scene, (COLUMN + offset) / 100, atol=1e-6)

    def test_orientations_come_from_where_joints_were_bound(self, load):
        scene = column_scene()
        link = np.eye(4)
        link[:3, :3], link[:3, 3] = QUARTER, REST[1]
        clusters = [r for r in scene[1][2] if r[0] == "Deformer" and r[1][2] == "Cluster"]
        held = {name: values for name, values, _ in clusters[1][2]}
        held["TransformLink"][0][:] = link.T.ravel()
        held["Transform"][0][:] = np.linalg.inv(link).T.ravel()
        rig = load(text(scene))
        check(rig)
        assert_allclose(rig.skeleton.orientations[1], QUARTER, atol=1e-6)


class TestMeshes:
    def test_polygons_are_cut_into_fans(self, load):
        corners = np.array([0, 1, 5, ~4, 8, 9, 10, ~11, 2, 3, ~7], np.int32)
        scene = column_scene()
        geometry = scene[1][2][0]
        geometry[2][1][1][0].resize(len(corners), refcheck=False)
        geometry[2][1][1][0][:] = corners
        expected = [[0, 1, 5], [0, 5, 4], [8, 9, 10], [8, 10, 11], [2, 3, 7]]
        assert load(text(scene)).mesh.faces.tolist() == expected

    def test_without_weights_the_mesh_is_bound_to_all_bones_as_they_stand(self, load):
        scene = [
            record(name, children=[c for c in children if c[0] != "Deformer"])
            if name == "Objects"
            else record(name, children=[c for c in children if 400 not in c[1]])
            for name, _, children in column_scene()
        ]
        scene[2] = record(
            "Connections",
            children=[c for c in scene[2][2] if not {401, 402} & set(c[1])],
        )
        rig = load(text(scene))
        assert rig.weights is None
        assert rig.skeleton.names == ("root", "tip", "tip_end")
        assert_allclose(rig.skeleton.joints[:2], REST, atol=1e-6)
        assert len(rig.clips) == 1

    def test_hidden_meshes_are_told(self, load):
        rig = load(text(column_scene(node=[prop("Visibility", 0.0, kind="Visibility")])))
        check(rig)
        assert rig.parts[0].hidden

    def test_a_mesh_without_a_skeleton_loads(self, load):
        scene = column_scene(curves=False)
        objects = [c for c in scene[1][2] if c[0] == "Geometry" or MESH in c[1]]
        links = [c for c in scene[2][2] if c[1][1] in (100, MESH)]
        scene[1:] = [record("Objects", children=objects), record("Connections", children=links)]
        rig = load(binary(scene))
        assert rig.skeleton.joints.shape == (0, 3)
        assert_allclose(rig.mesh.vertices, COLUMN / 100, atol=1e-7)

    def test_odd_weights_count_as_none(self, load):
        shares = SHARES.copy()
        shares[0, 0], shares[1, 0] = -1, np.nan
        rig = load(binary(column_scene(shares=shares)))
        assert rig.weights[:2].sum() == 0
        assert any("negative or not a number" in w for w in rig.warnings), rig.warnings


def test_bound_and_saved_as_a_glb_that_loads_again(load, tmp_path):
    rig = load(WAYS["binary 7.4"])
    bound = rig.with_weights(cutcell.bind(rig, 16).weights)
    cutcell.save(tmp_path / "out.glb", bound)
    again = cutcell.load(tmp_path / "out.glb")
    assert_allclose(again.weights, bound.weights, atol=1e-6)
    assert_allclose(again.skeleton.joints, rig.skeleton.joints, atol=1e-6)
    assert_allclose(again.clips[0].transforms[-1], rig.clips[0].transforms[-1], atol=1e-5)
    (report,) = reports(tmp_path / "out.glb")
    assert not errors(report)


def test_what_is_saved_is_no_longer_its_own_document(load, demo_paths):
    assert not keeps_document(load(WAYS["binary 7.4"]))
    assert keeps_document(cutcell.load(demo_paths[0]))


def test_it_cannot_be_written(load, tmp_path):
    rig = load(WAYS["binary 7.4"])
    with pytest.raises(cutcell.FileError, match=r'^out\.fbx: a rig cannot be saved as "\.fbx"'):
        cutcell.save(tmp_path / "out.fbx", rig)


@pytest.mark.isolated
class TestDamage:
    @pytest.mark.parametrize("part", [0.05, 0.5, 0.8])
    @pytest.mark.parametrize("way", ["text 7.4", "binary 7.4", "text 6.1"])
    def test_cut_short(self, load, way, part):
        whole = WAYS[way]
        with pytest.raises(cutcell.CutcellError, match=r"^column\.fbx: "):
            load(whole[: int(part * len(whole))])

    def test_something_else(self, load):
        with pytest.raises(cutcell.FileError, match=r"^a\.fbx: is not an FBX file"):
            load(b"this is a letter, not a character", "a.fbx")
        with pytest.raises(cutcell.FileError, match=r"^a\.fbx: the file is empty"):
            load(b"", "a.fbx")

    def test_absurd_counts(self, load):
        for wrong in (b"*4294967295", b"*99999999999999999999"):
            data = WAYS["text 7.4"].replace(b"*36", wrong)
            assert data != WAYS["text 7.4"]
            try:
                check(load(data))  # text says where an array ends anyway
            except cutcell.FileError as error:
                assert str(error).startswith("column.fbx: ")  # noqa: PT017
        data = WAYS["binary 7.4"].replace((36).to_bytes(4, "little"), b"\xff\xff\xff\xff")
        with pytest.raises(cutcell.FileError, match=r"^column\.fbx: cannot be read as FBX"):
            load(data)

    def test_a_face_of_a_vertex_that_is_not_there(self, load):
        faces = FACES.copy()
        faces[0, 0] = 4000
        with pytest.raises(cutcell.FileError, match=r"^column\.fbx: cannot be read as FBX: it"):
            load(binary(column_scene(faces=faces)))

    def test_no_meshes(self, load):
        scene = column_scene()
        scene[1] = record("Objects", children=[c for c in scene[1][2] if c[0] != "Geometry"])
        with pytest.raises(cutcell.FileError, match=r"^column\.fbx: has no mesh"):
            load(text(scene))

    def test_numbers_that_no_float_holds(self, load):
        scene = column_scene()
        scene[1][2][0][2][0][1][0][4] = 1e300
        with pytest.raises(cutcell.MeshError, match=r"^column\.fbx: .*not a finite number"):
            load(binary(scene))

    def test_a_transform_that_is_too_large(self, load):
        with pytest.raises(cutcell.FileError, match=r'^column\.fbx: node "body": "scale" must be'):
            load(binary(column_scene(node=[vector("Lcl Scaling", (1e160,) * 3)])))

    def test_a_reader_that_crashes_is_a_sentence(self, load, monkeypatch):
        code = "import os, signal; os.kill(os.getpid(), signal.SIGSEGV)"
        monkeypatch.setattr("cutcell.isolated.run.COMMAND", (sys.executable, "-c", code))
        with pytest.raises(cutcell.FileError, match=r"^column\.fbx: .*reader crashed .signal 11"):
            load(WAYS["text 7.4"])

    def test_damaged_bytes_are_sentences(self, load):
        random = np.random.default_rng(5)
        for way in ("text 7.4", "binary 7.4") * 4:
            data = bytearray(WAYS[way])
            for at in random.integers(0, len(data), 6):
                data[at] ^= 1 << random.integers(8)
            reported = "column.fbx: "
            try:
                load(bytes(data))
            except cutcell.CutcellError as error:
                reported = str(error)
            assert reported.startswith("column.fbx: ")


def changed(scene, keep=lambda one: True, objects=(), links=()):
    """Return a scene with other objects and connections between those that are left."""
    head, before, connections = scene
    objects = [*(one for one in before[2] if keep(one)), *objects]
    numbers = {0, *(one[1][0] for one in objects)}
    links = [*connections[2], *(record("C", "OO", a, b) for a, b in links)]
    links = [one for one in links if {one[1][1], one[1][2]} <= numbers]
    return [head, record("Objects", children=objects), record("Connections", children=links)]


def test_other_instances_of_a_skinned_mesh_are_told(load):
    again = model(210, "again", "Mesh", [vector("Lcl Translation", (5, 0, 0))])
    rig = load(text(changed(column_scene(), objects=[again], links=[(210, 0), (100, 210)])))
    check(rig)
    assert sum("again" in warning for warning in rig.warnings) == 1


def test_a_mesh_that_only_blend_shapes_move_says_so(load):
    shape = record(
        "Geometry", 412, "Geometry::smile", "Shape",
        children=[record("Indexes", np.array([0], np.int32)), record("Vertices", np.ones(3)),
                  record("Normals", np.zeros(3))],
    )  # fmt: skip
    blend = [
        record("Deformer", 410, "Deformer::face", "BlendShape"),
        record("Deformer", 411, "SubDeformer::smile", "BlendShapeChannel"),
        shape,
    ]
    unmoved = {"Deformer", "NodeAttribute"}
    scene = changed(
        column_scene(curves=False),
        lambda one: one[0] not in unmoved and one[1][0] not in (300, 301, 302),
        blend,
        [(410, 100), (411, 410), (412, 411)],
    )
    rig = load(text(scene))
    assert len(rig.skeleton.joints) == 0
    assert sum("morph targets (body)" in w for w in rig.warnings) == 1
    with pytest.raises(cutcell.SkeletonError, match="morph targets"):
        cutcell.bind(rig)


def test_meshes_that_all_hang_on_bones_are_bound(load):
    scene = changed(column_scene(), lambda one: one[0] != "Deformer")
    links = [record("C", "OO", MESH, 301) if c[1][1:3] == (MESH, 0) else c for c in scene[2][2]]
    rig = load(text([*scene[:2], record("Connections", children=links)]))
    assert set(rig.skeleton.names) == {"root", "tip", "tip_end"}
    assert rig.weights is None
    assert rig.attachments == ()


def test_an_accessory_is_bound_when_asked_for(tmp_path):
    corners = FACES.copy()
    corners[:, -1] = ~corners[:, -1]
    sword = record(
        "Geometry", 101, "Geometry::sword", "Mesh",
        children=[record("Vertices", COLUMN.astype(float).ravel()),
                  record("PolygonVertexIndex", corners.ravel().astype(np.int32))],
    )  # fmt: skip
    objects = [sword, model(210, "sword", "Mesh", [vector("Lcl Translation", (2, 0, 0))])]
    scene = changed(column_scene(), objects=objects, links=[(210, 301), (101, 210)])
    (tmp_path / "a.fbx").write_bytes(text(scene))
    assert [one.name for one in cutcell.load(tmp_path / "a.fbx").attachments] == ["sword"]
    rig = cutcell.load(tmp_path / "a.fbx", accessories=True)
    assert [part.name for part in rig.parts] == ["body", "sword"]
    assert_allclose(rig.mesh.vertices[12:], COLUMN + REST[1] + np.array([2, 0, 0]), atol=1e-6)


@pytest.mark.parametrize(
    ("kind", "name", "index", "width"),
    [
        ("UV", "UV", "UVIndex", 2),
        ("Normal", "Normals", "NormalsIndex", 3),
        ("Color", "Colors", "ColorIndex", 4),
    ],
)
def test_a_corner_whose_number_is_minus_one_has_no_value(load, tmp_path, kind, name, index, width):
    numbers = np.arange(FACES.size, dtype=np.int32)
    numbers[4] = -1
    values = np.tile(np.eye(4)[1, :width], FACES.size)
    rows = [record(name, values), record(index, numbers)]
    element = record("LayerElement", children=[record("Type", f"LayerElement{kind}")])
    mesh = [layer(kind, "ByPolygonVertex", rows), record("Layer", 0, children=[element])]
    rig = load(binary(column_scene(mesh=mesh)))
    check(rig)
    cutcell.save(tmp_path / "out.glb", rig)
    again = cutcell.load(tmp_path / "out.glb").mesh.vertices
    assert_allclose(np.unique(again, axis=0), np.unique(COLUMN, axis=0))


def renamed(scene, names):
    """Return records with other names in the place of some."""
    return [
        (
            name,
            tuple(names.get(v, v) if isinstance(v, str) else v for v in values),
            tuple(renamed(children, names)),
        )
        for name, values, children in scene
    ]


SAMPLES = {
    "cp932": ("右腕", "全ての親", "つま先"),
    "gbk": ("左手", "根骨骼", "尾巴"),
    "cp949": ("왼팔", "머리", "척추"),
    "cp1251": ("Рука", "Голова", "Кость"),
    "cp1252": ("Schädel", "Épaule", "Fuß"),
}


@pytest.mark.parametrize("write", [text, binary])
@pytest.mark.parametrize("encoding", SAMPLES)
def test_names_that_are_not_utf8_are_guessed_and_told(load, write, encoding):
    marks = {f"Model::{old}": f"Model::{'QXZ'[k] * 20}" for k, old in enumerate(("tip", "root"))}
    marks["AnimStack::bow"] = f"AnimStack::{'Z' * 20}"
    data = write(renamed(column_scene(), marks))
    for letter, name in zip("QXZ", SAMPLES[encoding], strict=True):
        raw = name.encode(encoding)
        data = data.replace(letter.encode() * 20, raw + b"_" * (20 - len(raw)))
    rig = load(data)
    names = [rig.skeleton.names[1], rig.skeleton.names[0], rig.clips[0].name]
    assert [name.rstrip("_") for name in names] == list(SAMPLES[encoding])
    assert sum(encoding in warning for warning in rig.warnings) == 1


def test_a_replacement_character_is_a_letter_like_any_other(load):
    rig = load(text(renamed(column_scene(), {"Model::tip": "Model::t\ufffdp"})))
    assert rig.skeleton.names[1] == "t\ufffdp"
    assert len(rig.warnings) == 1


@pytest.mark.parametrize("method", ["DualQuaternion", "Blend", "Linear"])
def test_dual_quaternions_are_told_once(load, method):
    scene = column_scene()
    skin = record("Deformer", 400, "Deformer::", "Skin", children=[record("SkinningType", method)])
    objects = [skin if one[1][0] == 400 else one for one in scene[1][2]]
    rig = load(text([scene[0], record("Objects", children=objects), scene[2]]))
    check(rig)
    warnings = [w for w in rig.warnings if "dual-quaternion skinning (body)" in w]
    assert len(warnings) == (method != "Linear")
