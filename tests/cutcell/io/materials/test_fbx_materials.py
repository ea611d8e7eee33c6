"""Base colours of FBX: by face and corner, images inside and beside."""

import os
from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

import cutcell
from cutcell.io.gltf.write.faces import with_faces
from cutcell.io.materials.face_colors import BLENDED, Layer
from cutcell.io.materials.transfer import has_materials, read_materials
from cutcell_viewers.materials import load_textures
from tests.cutcell.io.fbx_builder import binary, column_scene, prop, text, vector, with_materials
from tests.cutcell.io.gltf.gltf_builder import FACES

UV = np.random.default_rng(7).uniform(-1, 2, (len(FACES), 3, 2)).round(3)
IN_IMAGE = np.stack([UV[..., 0], 1 - UV[..., 1]], axis=2)
RED, BLUE = [vector("DiffuseColor", (1, 0, 0))], [vector("DiffuseColor", (0, 0, 0.5))]
INSIDE = {"file": "skin.png", "content": b"an image"}
HALVES = np.arange(len(FACES)) % 2


@pytest.fixture
def load(tmp_path):
    def loaded(scene, write=binary):
        (tmp_path / "column.fbx").write_bytes(write(scene))
        return cutcell.load(tmp_path / "column.fbx")

    return loaded


def scene(**given):
    return with_materials(column_scene(curves=False), UV, **given)


@pytest.mark.parametrize("write", [binary, text])
def test_an_image_inside_lies_where_each_corner_says(load, write):
    rig = load(scene(materials=[(RED, INSIDE)]), write)
    assert has_materials(rig)
    result = read_materials(rig)
    assert result.notes == ()
    assert [(one.name, one.content) for one in result.images] == [('image "skin.png"', b"an image")]
    assert result.layers == (Layer(0, color=(255, 0, 0)),)
    assert_allclose(result.body.corners[..., :2], IN_IMAGE, atol=1e-6)
    assert (result.body.corners[..., 2] == 0).all()
    assert (result.body.corners[..., 3] == 0).all()
    assert (result.body.tints == 255).all(), "the image takes the place of the colour"


def test_each_face_has_its_material(load):
    half = [*BLUE, prop("DiffuseFactor", 0.5)]
    rig = load(scene(polygons=HALVES, materials=[(RED, None), (half, None)]))
    assert has_materials(rig)
    tints = read_materials(rig).body.tints
    assert (tints[HALVES == 0] == (255, 0, 0)).all()
    assert (tints[HALVES == 1] == (0, 0, 64)).all()


def test_corners_have_colours_of_their_own(load):
    colors = np.random.default_rng(3).uniform(0, 1, (len(FACES), 3, 4)).round(2)
    white = [vector("DiffuseColor", (1, 1, 1))]
    rig = load(scene(materials=[(white, None)], colors=colors))
    assert has_materials(rig)
    assert_array_equal(read_materials(rig).body.tints, np.round(255 * colors[..., :3]))


@pytest.mark.parametrize("look", [(0.8, 0.8, 0.8), (1, 1, 1)])
def test_one_grey_is_nothing_to_see(load, look):
    rig = load(scene(materials=[([vector("DiffuseColor", look)], None)]))
    assert not has_materials(rig)


def test_without_materials_there_is_nothing_to_read(load):
    rig = load(column_scene(curves=False))
    assert not has_materials(rig)
    assert read_materials(rig).body.corners[..., 2].max() == -1


def test_an_image_is_moved_as_the_texture_says(load):
    look = [
        vector("Translation", (0.25, 0.5, 0)),
        vector("Scaling", (2, 4, 1)),
    ]
    result = read_materials(load(scene(materials=[(RED, {**INSIDE, "look": look})])))
    # FBX places the image over the texture coordinates: these take the inverse.
    moved = (UV - (0.25, 0.5)) / (2, 4)
    expected = np.stack([moved[..., 0], 1 - moved[..., 1]], axis=2)
    assert_allclose(result.body.corners[..., :2], expected, atol=1e-6)


def test_a_damaged_image_leaves_the_colour(load):
    result = load_textures(load(scene(materials=[(RED, INSIDE)])))
    assert result.notes == (
        'image "skin.png" cannot be shown: it is no PNG, JPEG, WebP, BMP or TGA, or damaged',
    )
    assert (result.body.tints == (255, 0, 0)).all()
    assert (result.body.corners[..., 2] == -1).all()


class TestBeside:
    def test_an_image_lies_beside_by_its_name(self, load, tmp_path):
        (tmp_path / "skin.png").write_bytes(b"beside")
        result = read_materials(load(scene(materials=[(RED, {"file": "skin.png"})])))
        assert result.images[0].content == b"beside"

    @pytest.mark.parametrize("file", ["..\\skin.png", "../../skin.png", "/elsewhere/skin.png"])
    def test_a_name_of_another_machine_is_looked_for_in_the_folder(self, load, tmp_path, file):
        rig = load(scene(materials=[(RED, {"file": file})]))
        (tmp_path.parent / "skin.png").write_bytes(b"of somebody else")
        result = read_materials(rig)
        assert result.images == ()
        assert result.notes == (
            'material "paint 0" is used without what could not be read of it: image "skin.png" is '
            "not in the folder of column.fbx",
        )
        assert (result.body.tints == (255, 0, 0)).all()
        (tmp_path / "skin.png").write_bytes(b"beside")
        assert read_materials(rig).images[0].content == b"beside"

    def test_a_folder_below_comes_first(self, load, tmp_path):
        (tmp_path / "textures").mkdir()
        (tmp_path / "textures/skin.png").write_bytes(b"below")
        (tmp_path / "skin.png").write_bytes(b"beside")
        rig = load(scene(materials=[(RED, {"file": "textures\\skin.png"})]))
        assert read_materials(rig).images[0].content == b"below"

    def test_links_lead_nowhere(self, load, tmp_path):
        (tmp_path.parent / "secret.png").write_bytes(b"of somebody else")
        os.symlink(tmp_path.parent / "secret.png", tmp_path / "skin.png")
        result = read_materials(load(scene(materials=[(RED, {"file": "skin.png"})])))
        assert result.images == ()
        assert "a file outside of its folder" in result.notes[0]

    def test_too_large_a_file_is_not_read(self, load, tmp_path):
        with (tmp_path / "skin.png").open("wb") as file:
            file.truncate(2**29)
        result = read_materials(load(scene(materials=[(RED, {"file": "skin.png"})])))
        assert "has 512 MB, more than is read" in result.notes[0]


@pytest.mark.parametrize(
    ("color", "share", "opacity"),
    [((1, 1, 1), 0.25, 191), ((0, 0, 0), 1, 255), ((1, 1, 1), 1, 255)],
)
def test_what_is_behind_may_shine_through(load, color, share, opacity):
    look = [*RED, vector("TransparentColor", color), prop("TransparencyFactor", share)]
    body = read_materials(load(scene(materials=[(look, None)]))).body
    assert (body.opacity == opacity).all()
    assert (body.corners[..., 3] == (BLENDED if opacity < 255 else 0)).all()


def test_faces_that_were_repaired_keep_their_colours(load):
    rig = load(scene(materials=[(RED, INSIDE)]))
    kept, turned = np.ones(len(FACES), bool), np.zeros(len(FACES), bool)
    kept[[2, 5]] = False
    turned[4] = True
    result = read_materials(with_faces(rig, kept, turned))
    expected = IN_IMAGE.copy()
    expected[4] = expected[4, [0, 2, 1]]
    assert_allclose(result.body.corners[..., :2], expected[kept], atol=1e-6)


def test_another_mesh_has_none_of_it(load):
    rig = load(scene(materials=[(RED, INSIDE)]))
    mesh = cutcell.TriangleMesh(rig.mesh.vertices, rig.mesh.faces[:-1])
    assert read_materials(replace(rig, mesh=mesh)) is None
