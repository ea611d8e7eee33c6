"""Base colours of other formats in a GLB: what is saved is seen again, on the same vertices."""

import sys
from dataclasses import replace
from functools import partial
from io import BytesIO
from pathlib import Path

import numpy as np
import pytest
import trimesh
from numpy.testing import assert_allclose, assert_array_equal
from PIL import Image

import cutcell
from cutcell.io import saving_notes
from cutcell.io.gltf.write.faces import with_faces
from cutcell.io.materials.face_colors import BLENDED
from cutcell.io.materials.transfer import has_materials, read_materials
from cutcell.runtime.colors import linear, srgb
from tests.cutcell.io.fbx_builder import (
    END,
    MESH,
    ROOT,
    TIP,
    binary,
    column_scene,
    model,
    record,
    vector,
    with_materials,
)
from tests.cutcell.io.gltf.gltf_builder import COLUMN, FACES, REST, SHARES, column
from tests.cutcell.io.materials.test_gltf_materials import with_image
from tests.cutcell.io.materials.test_obj_materials import IN_IMAGE, RED, SKIN, lines
from tests.gltf_validator.validator import reports

IN_FILE = IN_IMAGE * (1, -1) + (0, 1)
OF_SCENES = {"NODE_SKINNED_MESH_NON_ROOT", "BUFFER_VIEW_TARGET_MISSING"}
"""What the validator finds in files that are made of an FBX, with or without materials."""
HALVES = np.arange(len(FACES)) % 2
BY_MATERIAL = np.argsort(HALVES, kind="stable")


def picture(kind, side=4, **how):
    """Return an image with a red upper half and a blue lower one."""
    pixels = np.zeros((side, side, 3), np.uint8)
    pixels[: side // 2, :, 0] = pixels[side // 2 :, :, 2] = 255
    packed = BytesIO()
    Image.fromarray(pixels).save(packed, kind, **how)
    return packed.getvalue()


SKIN_PNG = picture("PNG")
INSIDE = {"file": "skin.png", "content": SKIN_PNG}


def bound(rig):
    """Return a rig with a skeleton and weights, if it has none."""
    if rig.weights is not None:
        return rig
    size = np.ptp(rig.mesh.vertices[:, 1]) / np.ptp(COLUMN[:, 1])  # an FBX is in centimetres
    skeleton = cutcell.Skeleton(size * REST, [-1, 0], ("root", "tip"))
    return replace(rig, skeleton=skeleton, weights=SHARES[:, :2])


def load_obj(folder, text, mtl="", **images):
    """Write an OBJ with its files and load it."""
    (folder / "column.obj").write_text(text)
    (folder / "column.mtl").write_text(mtl)
    for name, content in images.items():
        (folder / f"{name}.png").write_bytes(content)
    return bound(cutcell.load(folder / "column.obj"))


@pytest.fixture
def obj(tmp_path):
    return partial(load_obj, tmp_path)


@pytest.fixture
def fbx(tmp_path):
    def loaded(**given):
        scene = with_materials(column_scene(curves=False), IN_FILE, **given)
        (tmp_path / "column.fbx").write_bytes(binary(scene))
        return cutcell.load(tmp_path / "column.fbx")

    return loaded


def load_again(folder, rig, name="out.glb"):
    """Save a rig, see that the file is valid, and load it."""
    cutcell.save(folder / name, rig)
    (report,) = reports(folder / name)
    # Texture coordinates are stored without an image as well.
    messages = [m for m in report["issues"]["messages"] if not m["pointer"].endswith("TEXCOORD_0")]
    assert {message["code"] for message in messages} <= OF_SCENES
    return cutcell.load(folder / name)


@pytest.fixture
def again(tmp_path):
    return partial(load_again, tmp_path)


def check_same(rig, found, order=slice(None)):
    """Check vertices, weights and, in the order of their materials, faces with their colours."""
    count = len(rig.mesh.vertices)
    vertices, faces = rig.mesh.vertices.astype(np.float32), rig.mesh.faces[order]
    assert_array_equal(found.mesh.vertices[:count], vertices)  # copies at seams follow
    assert_array_equal(found.mesh.vertices[found.mesh.faces], vertices[faces])
    corners = found.mesh.faces.ravel()
    assert_allclose(found.weights[corners], rig.weights[faces.ravel()], atol=1e-7)
    before, after = read_materials(rig), read_materials(found)
    assert_array_equal(after.body.tints, before.body.tints[order])
    assert_array_equal(after.body.opacity, before.body.opacity[order])
    assert_array_equal(after.body.corners, before.body.corners[order])
    assert [one.content for one in after.images] == [one.content for one in before.images]
    return after


class TestObj:
    def test_materials_images_and_coordinates(self, obj, again):
        rig = obj(lines("red", "skin"), RED + SKIN, skin=SKIN_PNG)
        result = check_same(rig, again(rig), BY_MATERIAL)
        assert result.names == ("red", "skin")

    def test_faces_of_one_material_keep_their_order(self, obj, again):
        rig = obj(lines("skin"), SKIN, skin=SKIN_PNG)
        check_same(rig, again(rig))

    def test_another_library_sees_the_image_the_same_way_up(self, obj, again, tmp_path):
        rig = obj(lines("skin"), SKIN, skin=SKIN_PNG)
        again(rig)
        scene = trimesh.load(tmp_path / "out.glb", process=False)
        (mesh,) = scene.geometry.values()
        uv = mesh.visual.uv[mesh.faces]  # trimesh counts from the lower left corner, as OBJ does
        assert_allclose(uv, IN_FILE, atol=1e-6)
        assert_allclose(mesh.vertices[mesh.faces], COLUMN[FACES])
        assert mesh.visual.material.baseColorTexture.getpixel((0, 0)) == (255, 0, 0)

    def test_what_shines_through(self, obj, again):
        mtl = f"{SKIN}map_d skin.png\n{RED}d 0.5\nnewmtl end\nmap_Kd skin.png\n"
        rig = obj(lines("skin", "red", "end"), mtl, skin=SKIN_PNG)
        result = check_same(rig, again(rig), np.argsort(np.arange(len(FACES)) % 3, kind="stable"))
        assert set(result.body.corners[:, 0, 3].astype(int)) == {0, BLENDED}
        assert len(result.images) == 1

    def test_colours_of_vertices(self, obj, again):
        colors = np.random.default_rng(1).uniform(0, 1, (len(COLUMN), 3)).round(2)
        points = [
            f"v {x} {y} {z} {r} {g} {b}"
            for (x, y, z), (r, g, b) in zip(COLUMN, colors, strict=True)
        ]
        rig = obj("\n".join([*points, *(f"f {a} {b} {c}" for a, b, c in FACES + 1)]))
        result = again(rig)
        check_same(rig, result)
        accessors = result.source.document.items("accessors")
        assert accessors[0]["count"] == len(COLUMN), "there is no seam"

    def test_an_image_that_is_not_there_leaves_the_colour(self, obj, again):
        rig = obj(lines("skin"), SKIN)
        result = check_same(rig, again(rig))
        assert (result.body.tints == (128, 255, 255)).all()
        (note,) = saving_notes(Path("out.glb"), rig)
        assert 'image "skin.png" is not in the folder of column.obj' in note

    @pytest.mark.parametrize("kind", ["TGA", "BMP", "WEBP"])
    def test_an_image_of_another_format_becomes_png(self, obj, again, kind):
        rig = obj(lines("skin"), SKIN, skin=picture(kind, lossless=True))
        result = read_materials(again(rig))
        assert saving_notes(Path("out.glb"), rig) == ()
        with Image.open(BytesIO(result.images[0].content)) as image:
            assert image.format == "PNG"
            assert image.getpixel((0, 0)) == (255, 0, 0)
        assert_array_equal(result.body.corners, read_materials(rig).body.corners)

    def test_a_damaged_image_leaves_the_colour_and_is_told(self, obj, again):
        rig = obj(lines("skin"), SKIN, skin=b"an image")
        result = read_materials(again(rig))
        assert result.images == ()
        assert (result.body.tints == (128, 255, 255)).all()
        (note,) = saving_notes(Path("out.glb"), rig)
        assert note == (
            'image "skin.png" is not saved, and its material has its colour alone: it is no PNG, '
            "JPEG, WebP, BMP or TGA, or damaged"
        )
        assert saving_notes(Path("out.npz"), rig) == ()

    def test_an_image_of_too_many_pixels_is_told(self, obj):
        huge = bytearray(picture("BMP"))
        huge[18:26] = np.array([2**14, 2**13], "<u4").tobytes()
        rig = obj(lines("skin"), SKIN, skin=bytes(huge))
        assert "more than 67 million pixels" in saving_notes(Path("out.glb"), rig)[0]

    def test_without_a_decoder_the_image_is_left_out(self, obj, again, monkeypatch):
        rig = obj(lines("skin"), SKIN, skin=picture("TGA", side=6))
        monkeypatch.setitem(sys.modules, "PIL", None)
        assert read_materials(again(rig)).images == ()
        assert "try: pip install pillow" in saving_notes(Path("out.glb"), rig)[0]

    def test_no_image_from_elsewhere_is_taken_in(self, obj, again, tmp_path):
        (tmp_path.parent / "secret.png").write_bytes(SKIN_PNG)
        rig = obj(lines("skin"), SKIN.replace("skin.png", "../secret.png"))
        assert read_materials(again(rig)).images == ()

    def test_one_grey_is_saved_as_ever(self, obj, again, tmp_path):
        text = "\n".join(line for line in lines("grey").splitlines() if not line.startswith("vt"))
        again(replace(obj(text, "newmtl grey\nKd 0.8 0.8 0.8\n"), name="column"))
        colored = (tmp_path / "out.glb").read_bytes()
        again(replace(obj("\n".join(lines().splitlines()[1:])), source=None))
        assert (tmp_path / "out.glb").read_bytes() == colored

    def test_other_formats_are_saved_as_ever(self, obj, tmp_path):
        rig = obj(lines("skin"), SKIN, skin=SKIN_PNG)
        for name in ("a.npz", "b.npz"):
            cutcell.save(tmp_path / name, rig if name == "a.npz" else replace(rig, source=None))
        assert (tmp_path / "a.npz").read_bytes() == (tmp_path / "b.npz").read_bytes()


class TestFbx:
    def test_materials_images_and_coordinates(self, fbx, again):
        looks = [([vector("DiffuseColor", (1, 0, 0))], None), ([], INSIDE)]
        rig = fbx(polygons=HALVES, materials=looks)
        result = check_same(rig, again(rig), BY_MATERIAL)
        assert result.names == ("paint 0", "paint 1")

    def test_a_gltf_beside_its_buffer_has_them_too(self, fbx, again):
        rig = fbx(materials=[([], INSIDE)])
        check_same(rig, again(rig, "out.gltf"))

    def test_repaired_faces_keep_their_colours(self, fbx, again):
        rig = fbx(materials=[([], INSIDE)])
        kept, turned = np.ones(len(FACES), bool), np.zeros(len(FACES), bool)
        kept[[2, 5]], turned[4] = False, True
        mended = with_faces(rig, kept, turned)
        check_same(mended, again(mended))

    @pytest.mark.parametrize("linked", [True, False])
    def test_what_hangs_on_a_joint_has_them_too_or_is_plain(self, again, tmp_path, linked):
        given = {"materials": [([], INSIDE)]}
        head, objects, connections = with_materials(column_scene(curves=False), IN_FILE, **given)
        name, (_, *rest), below = objects[2][0]
        sword = [(name, (700, *rest), below), model(701, "sword", "Mesh", ())]
        pairs = [(700, 701), (701, TIP), *([(900, 701)] if linked else [])]
        links = [record("C", "OO", *pair) for pair in pairs]
        scene = [
            head,
            record("Objects", children=[*objects[2], *sword]),
            record("Connections", children=[*connections[2], *links]),
        ]
        (tmp_path / "column.fbx").write_bytes(binary(scene))
        rig = cutcell.load(tmp_path / "column.fbx")
        result = again(rig)
        check_same(rig, result)
        (before,), (after,) = rig.attachments, result.attachments
        corners = [one.mesh.vertices[one.mesh.faces] for one in (before, after)]
        assert_allclose(corners[1], corners[0], atol=1e-6)
        (before,), (after,) = read_materials(rig).attachments, read_materials(result).attachments
        assert_array_equal(after.corners, before.corners)
        materials = result.source.document.items("materials")
        assert [one["name"] for one in materials] == ["paint 0", *([] if linked else ["plain"])]

    def test_without_a_skin(self, again, tmp_path):
        given = {"materials": [([], INSIDE)]}
        head, objects, _ = with_materials(column_scene(curves=False), IN_FILE, **given)
        links = [(MESH, 0), (100, MESH), (900, MESH), (940, 920)]
        made = [record("C", "OO", *pair) for pair in links]
        made.append(record("C", "OP", 920, 900, "DiffuseColor"))
        bones = ("Deformer", "NodeAttribute")
        kept = [
            one for one in objects[2] if one[0] not in bones and one[1][0] not in (ROOT, TIP, END)
        ]
        scene = [head, record("Objects", children=kept), record("Connections", children=made)]
        (tmp_path / "column.fbx").write_bytes(binary(scene))
        rig = bound(cutcell.load(tmp_path / "column.fbx"))
        assert has_materials(rig)
        check_same(rig, again(rig))


def test_a_mesh_without_a_skin_that_becomes_a_new_file_keeps_them(tmp_path, again):
    builder = column()
    with_image(builder, SKIN_PNG, {}, alphaMode="MASK", alphaCutoff=0.25)
    node = next(node for node in builder.json["nodes"] if "mesh" in node)
    del builder.json["skins"], node["skin"]
    node["scale"] = [-1, 1, 1]
    rig = bound(cutcell.load(builder.save(tmp_path / "bare.glb")))
    result = check_same(rig, again(rig))
    assert result.layers[0].cutoff == 0.25


def test_linear_colours_are_those_of_pictures():
    every = np.arange(256)
    assert_array_equal(srgb(linear(every)), every)
    assert_array_equal(srgb(np.round(65535 * linear(every)) / 65535), every)
