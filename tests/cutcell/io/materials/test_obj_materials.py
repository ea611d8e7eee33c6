"""Base colours of OBJ with .mtl, and of PLY and OFF: by face, corner and vertex."""

from dataclasses import replace

import numpy as np
import pytest
import trimesh
from numpy.testing import assert_allclose, assert_array_equal

import cutcell
from cutcell.io.gltf.write.faces import with_faces
from cutcell.io.materials.face_colors import BLENDED, Layer
from cutcell.io.materials.surfaces import stored_corners
from cutcell.io.materials.transfer import has_materials, read_materials
from tests.cutcell.io.gltf.gltf_builder import COLUMN, FACES

UV = np.random.default_rng(5).uniform(0, 1, (3 * len(FACES), 2)).round(3)
IN_IMAGE = np.stack([UV[:, 0], 1 - UV[:, 1]], axis=1).reshape(-1, 3, 2)
RED = "newmtl red\nKd 1 0 0\n"
SKIN = "newmtl skin\nKd 0.5 1 1\nmap_Kd skin.png\n"


def lines(*names, library="mtllib column.mtl"):
    """Return the column as OBJ text, its faces dealt to materials in turn."""
    result = [library, *(f"v {x} {y} {z}" for x, y, z in COLUMN)]
    result += [f"vt {u} {v}" for u, v in UV]
    for k, face in enumerate(FACES + 1):
        if names:
            result.append(f"usemtl {names[k % len(names)]}")
        result.append("f " + " ".join(f"{a}/{3 * k + c + 1}" for c, a in enumerate(face)))
    return "\n".join(result) + "\n"


@pytest.fixture
def load(tmp_path):
    def loaded(text, mtl=None, **images):
        (tmp_path / "column.obj").write_text(text)
        if mtl is not None:
            (tmp_path / "column.mtl").write_text(mtl)
        for name, content in images.items():
            (tmp_path / f"{name}.png").write_bytes(content)
        return cutcell.load(tmp_path / "column.obj")

    return loaded


def test_faces_have_their_materials(load):
    rig = load(lines("red", "skin"), RED + SKIN, skin=b"an image")
    assert has_materials(rig)
    result = read_materials(rig)
    assert result.notes == ()
    assert [(one.name, one.content) for one in result.images] == [('image "skin.png"', b"an image")]
    assert result.layers == (Layer(0),)
    assert (result.body.tints[::2] == (255, 0, 0)).all()
    assert (result.body.corners[::2, :, 2] == -1).all()
    assert (result.body.tints[1::2] == (128, 255, 255)).all()
    assert (result.body.corners[1::2, :, 2] == 0).all()
    assert_allclose(result.body.corners[1::2, :, :2], IN_IMAGE[1::2], atol=1e-6)


def test_polygons_are_cut_as_the_mesh_is(load):
    text = "mtllib column.mtl\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 1\n"
    text += (
        "vt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nusemtl skin\nf 1/1 2/2 3/3 4/4\nf 1 2 5\nf -3/-2 5 1/9\n"
    )
    result = read_materials(load(text, SKIN, skin=b"an image")).body.corners[..., :2]
    assert_array_equal(result[0], [[0, 1], [1, 1], [1, 0]])
    assert_array_equal(result[1], [[0, 1], [1, 0], [0, 0]])
    # A corner without one lies at 0 0.
    assert_array_equal(result[3], [[1, 0], [0, 1], [0, 1]])


def test_a_template_a_bind_and_a_repair_keep_them(load):
    rig = load(lines("red", "skin"), RED + SKIN, skin=b"an image")
    joints = cutcell.Skeleton([[0.5, 0, 0.5], [0.5, 1, 0.5]], [-1, 0])
    rig = replace(rig, skeleton=joints, weights=np.tile([0.5, 0.5], (len(COLUMN), 1)))
    whole = read_materials(rig).body
    assert whole.corners[..., 2].max() == 0
    kept, turned = np.ones(len(FACES), bool), np.zeros(len(FACES), bool)
    kept[3] = False
    turned[5] = True
    some = read_materials(with_faces(rig, kept, turned)).body
    assert_array_equal(some.corners[2], whole.corners[2])
    assert_array_equal(some.corners[4], whole.corners[5][[0, 2, 1]])
    assert_array_equal(some.tints[3], whole.tints[4])


def test_a_rignet_rig_has_them_too(load, tmp_path):
    (tmp_path / "column.txt").write_text("joints a 0 0 0\njoints b 0 1 0\nroot a\nhier a b\n")
    rig = load(lines("red"), RED)
    assert len(rig.skeleton.joints) == 2
    assert (read_materials(rig).body.tints == (255, 0, 0)).all()


def test_vertices_may_have_colours(load):
    colors = np.random.default_rng(1).uniform(0, 1, (len(COLUMN), 3)).round(2)
    points = [
        f"v {x} {y} {z} {r} {g} {b}" for (x, y, z), (r, g, b) in zip(COLUMN, colors, strict=True)
    ]
    rig = load("\n".join(points + [f"f {a} {b} {c}" for a, b, c in FACES + 1]))
    assert has_materials(rig)
    assert_array_equal(read_materials(rig).body.tints, np.round(255 * colors)[FACES])


@pytest.mark.parametrize("end", ["ply", "off"])
def test_other_meshes_may_have_them(tmp_path, end):
    colors = np.random.default_rng(2).integers(0, 256, (len(COLUMN), 4)).astype(np.uint8)
    colors[:, 3] = 255
    mesh = trimesh.Trimesh(COLUMN, FACES, vertex_colors=colors, process=False)
    mesh.export(tmp_path / f"column.{end}")
    rig = cutcell.load(tmp_path / f"column.{end}")
    if end == "ply":
        assert has_materials(rig)
        assert_array_equal(read_materials(rig).body.tints, colors[FACES][..., :3])


@pytest.mark.parametrize("end", ["obj", "ply", "off", "stl"])
def test_most_have_none(tmp_path, end):
    trimesh.Trimesh(COLUMN, FACES, process=False).export(tmp_path / f"column.{end}")
    rig = cutcell.load(tmp_path / f"column.{end}")
    assert not has_materials(rig)
    assert read_materials(rig) is None


class TestMtl:
    @pytest.mark.parametrize(
        ("said", "file"),
        [
            ("map_Kd skin.png", "skin.png"),
            ("map_Kd -clamp on my skin.png", "my skin.png"),
            ("map_kd -o 1 2 -s 1 1 1 -mm 0 1 -blendu off skin.png", "skin.png"),
            ("map_Kd C:\\work\\tex\\skin.png", "skin.png"),
        ],
    )
    def test_an_image_may_have_options(self, load, tmp_path, said, file):
        (tmp_path / file).write_bytes(b"an image")
        result = read_materials(load(lines("skin"), f"newmtl skin\n{said}\n"))
        assert result.notes == ()
        assert result.images[0].content == b"an image"

    def test_alpha_counts_where_an_image_says_so(self, load):
        result = read_materials(load(lines("skin"), SKIN + "map_d skin.png\n", skin=b"an image"))
        assert result.layers == (Layer(0, blended=True),)

    @pytest.mark.parametrize(
        ("said", "opacity"), [("d 0.5", 128), ("Tr 0.75", 64), ("d 0", 255), ("d x", 255)]
    )
    def test_what_is_behind_may_shine_through(self, load, said, opacity):
        body = read_materials(load(lines("red"), f"{RED}{said}\n")).body
        assert (body.opacity == opacity).all()
        assert (body.corners[..., 3] == (BLENDED if opacity < 255 else 0)).all()

    def test_black_with_an_image_is_the_image(self, load):
        mtl = "newmtl skin\nKd 0 0 0\nmap_Kd skin.png\n"
        assert (read_materials(load(lines("skin"), mtl, skin=b"x")).body.tints == 255).all()

    @pytest.mark.parametrize("said", ["Kd", "Kd red", "Kd nan 1 1", "Kd spectral file.rfl 1"])
    def test_a_colour_that_cannot_be_read_is_white(self, load, said):
        result = read_materials(load(lines("red"), f"newmtl red\n{said}\n"))
        assert (result.body.tints == 255).all()

    def test_several_libraries_and_names_with_spaces(self, load, tmp_path):
        (tmp_path / "a b.mtl").write_text("newmtl my skin\nKd 0 0 1\n")
        (tmp_path / "c.mtl").write_text(RED)
        rig = load(lines("my skin", "red", library="mtllib a b.mtl\nmtllib c.mtl c.mtl"))
        assert (read_materials(rig).body.tints[::2] == (0, 0, 255)).all()
        assert (read_materials(rig).body.tints[1::2] == (255, 0, 0)).all()


class TestWhatIsMissing:
    def test_the_library(self, load):
        rig = load(lines("red"))
        assert not has_materials(rig), "there is nothing to be seen"
        assert read_materials(rig).notes == (
            "the materials of column.obj are not used: column.mtl is not in the folder of "
            "column.obj",
        )

    def test_a_material(self, load):
        rig = load(lines("red", "green"), RED)
        assert has_materials(rig)
        (note,) = read_materials(rig).notes
        assert note == 'no .mtl file tells of the materials that faces have ("green")'

    def test_an_image_leaves_the_colour(self, load):
        result = read_materials(load(lines("skin"), SKIN))
        assert result.images == ()
        assert 'material "skin"' in result.notes[0]
        assert 'image "skin.png" is not in the folder of column.obj' in result.notes[0]
        assert (result.body.tints == (128, 255, 255)).all()
        assert (result.body.corners[..., 2] == -1).all()

    def test_texture_coordinates(self, load):
        text = "\n".join(line for line in lines("skin").splitlines() if line[:2] != "vt")
        result = read_materials(load(text, SKIN, skin=b"an image"))
        assert "no texture coordinates" in result.notes[0]

    @pytest.mark.parametrize("name", ["../column.mtl", "/etc/column.mtl", "\0", "..", "x" * 5000])
    def test_no_library_is_read_from_elsewhere(self, load, tmp_path, name):
        (tmp_path.parent / "column.mtl").write_text(RED)
        rig = load(lines("red", library=f"mtllib {name}"))
        assert not has_materials(rig)
        (note,) = read_materials(rig).notes
        assert len(note) < 300

    def test_a_library_that_is_too_large_is_not_read(self, load, tmp_path):
        with (tmp_path / "column.mtl").open("wb") as file:
            file.truncate(2**25)
        (note,) = read_materials(load(lines("red"))).notes
        assert "has 32 MB, more than is read" in note

    def test_odd_numbers_are_none(self, load):
        text = (
            lines("skin").replace("vt 0.", "vt nan", 4).replace("/1 ", "/x ").replace("/2 ", "/0 ")
        )
        result = read_materials(load(text, SKIN, skin=b"an image"))
        assert np.isfinite(result.body.corners).all()

    def test_an_image_that_is_no_file(self, load, tmp_path):
        (tmp_path / "skin.png").mkdir()
        assert "is not in the folder" in read_materials(load(lines("skin"), SKIN)).notes[0]


class TestStoredCorners:
    def test_faces_with_the_same_corners_are_told_apart_by_their_order(self):
        stored = np.array([[0, 1, 2], [2, 1, 3], [0, 2, 1], [0, 1, 2]])
        result = stored_corners(stored, stored[[0, 1, 2]][:, [0, 2, 1]])
        assert_array_equal(result, [[0, 2, 1], [3, 5, 4], [6, 8, 7]])

    def test_other_faces_are_none(self):
        stored = np.array([[0, 1, 2], [2, 1, 3]])
        assert stored_corners(stored, np.array([[0, 1, 3]])) is None
        assert stored_corners(stored, np.array([[9, 8, 7]])) is None
        assert stored_corners(stored, stored[[0, 0]]) is None

    def test_most_faces_of_a_large_mesh(self):
        stored = np.random.default_rng(0).integers(0, 50_000, (100_000, 3))
        result = stored_corners(stored, np.delete(stored, 7, axis=0))
        assert (result[:7, 0] == 3 * np.arange(7)).all()
        assert result[-1, 0] == 3 * 99_999
