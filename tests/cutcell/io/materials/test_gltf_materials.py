"""Base colours of glTF materials: which corner of which face has which, and what is refused."""

from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

import cutcell
from cutcell.io.gltf.write.faces import with_faces
from cutcell.io.materials.face_colors import BLENDED, CLAMP, MIRROR, Layer
from cutcell.io.materials.transfer import has_materials, read_materials
from cutcell.runtime.colors import srgb
from tests.cutcell.io.gltf.gltf_builder import COLUMN, FACES, column

UV = np.stack([np.linspace(0, 2, 12), np.linspace(-1, 1, 12)], axis=1).astype("f4")
RED, BLUE = (1, 0, 0, 1), (0, 0, 0.5, 1)


def factor(rgba):
    return {"pbrMetallicRoughness": {"baseColorFactor": list(rgba)}}


def primitive(builder):
    return builder.json["meshes"][0]["primitives"][0]


def with_image(builder, content=b"an image", sampler=None, mime="image/png", **material):
    """Give the column a material with an image, of any bytes, and texture coordinates."""
    view = builder.view(content)
    image = builder.add("images", {"name": "skin", "bufferView": view, "mimeType": mime})
    texture = {"source": image}
    if sampler is not None:
        texture["sampler"] = builder.add("samplers", sampler)
    number = builder.add("textures", texture)
    pbr = {"baseColorTexture": {"index": number, **material.pop("info", {})}}
    pbr |= material.pop("pbr", {})
    part = primitive(builder)
    part["material"] = builder.add("materials", {"pbrMetallicRoughness": pbr, **material})
    part["attributes"]["TEXCOORD_0"] = builder.accessor(UV)
    return builder


def second_part(builder, faces, **fields):
    """Let a second primitive draw some faces of the same vertices."""
    whole = primitive(builder)
    more = {**whole, "indices": builder.accessor(np.asarray(faces).reshape(-1)), **fields}
    builder.json["meshes"][0]["primitives"].append(more)


def test_colours_are_stored_as_pictures_store_them():
    linear = np.array([0, 0.002, 0.2140411, 1, 7, -1, np.nan])
    assert_array_equal(srgb(linear), [0, 7, 127, 255, 255, 0, 0])


def test_a_factor_colours_all_corners(loaded):
    builder = column()
    primitive(builder)["material"] = builder.add("materials", factor(RED))
    rig = loaded(builder)
    assert has_materials(rig)
    result = read_materials(rig)
    assert result.layers == result.images == result.notes == ()
    assert_array_equal(result.body.tints, np.broadcast_to([255, 0, 0], (len(FACES), 3, 3)))
    assert (result.body.corners[..., 2] == -1).all()


@pytest.mark.parametrize("material", [None, factor((0.8, 0.8, 0.8, 1)), {}])
def test_one_grey_is_nothing_to_see(loaded, material):
    builder = column()
    if material is not None:
        primitive(builder)["material"] = builder.add("materials", material)
    assert not has_materials(loaded(builder))


def test_two_materials_keep_their_faces_though_they_share_vertices(loaded):
    builder = column()
    part = primitive(builder)
    part["material"] = builder.add("materials", factor(RED))
    second_part(builder, FACES[:5], material=builder.add("materials", factor(BLUE)))
    rig = loaded(builder)
    assert len(rig.mesh.vertices) == len(COLUMN)
    tints = read_materials(rig).body.tints
    assert (tints[: len(FACES)] == (255, 0, 0)).all()
    assert (tints[len(FACES) :] == (0, 0, srgb(0.5))).all()


def test_vertices_have_colours_of_their_own_times_the_factor(loaded):
    builder = column()
    colors = np.random.default_rng(3).integers(0, 256, (12, 4)).astype("u1")
    part = primitive(builder)
    part["attributes"]["COLOR_0"] = builder.accessor(colors, normalized=True)
    part["material"] = builder.add("materials", factor((1, 0.5, 1, 1)))
    rig = loaded(builder)
    assert has_materials(rig)
    linear = colors[FACES][..., :3] / 255 * (1, 0.5, 1)
    assert_array_equal(read_materials(rig).body.tints, srgb(linear))


def test_each_corner_lies_where_its_vertex_does_in_the_image(loaded):
    sampler = {"wrapS": 33071, "wrapT": 33648, "magFilter": 9728}
    rig = loaded(with_image(column(), sampler=sampler, pbr={"baseColorFactor": [0.5, 1, 1, 1]}))
    assert has_materials(rig)
    result = read_materials(rig)
    assert [(one.name, one.content) for one in result.images] == [('image "skin"', b"an image")]
    assert result.layers == (Layer(0, nearest=True),)
    assert_allclose(result.body.corners[..., :2], UV[FACES])
    assert (result.body.corners[..., 2] == 0).all()
    assert (result.body.corners[..., 3] == 3 * CLAMP + MIRROR).all()
    assert (result.body.tints == (srgb(0.5), 255, 255)).all()


def test_an_image_is_moved_turned_and_scaled_as_the_extension_says(loaded):
    said = {"offset": [0.25, -1], "rotation": 0.4, "scale": [2, 3]}
    info = {"extensions": {"KHR_texture_transform": said}}
    result = read_materials(loaded(with_image(column(), info=info)))
    c, s = np.cos(0.4), np.sin(0.4)
    move, scale = np.array([[1, 0, 0.25], [0, 1, -1], [0, 0, 1]]), np.diag([2, 3, 1])
    turn = np.array([[c, s, 0], [-s, c, 0], [0, 0, 1]])  # as the extension's text has it
    expected = np.column_stack([UV, np.ones(12)]) @ (move @ turn @ scale).T
    assert_allclose(result.body.corners[..., :2], expected[FACES][..., :2], atol=1e-5)


def test_the_extensions_own_example_shows_the_lower_left_quarter(loaded):
    said = {"offset": [0, 1], "rotation": np.pi / 2, "scale": [0.5, 0.5]}
    builder = with_image(column(), info={"extensions": {"KHR_texture_transform": said}})
    square = np.array([[0, 0], [1, 0], [1, 1], [0, 1]] * 3, "f4")
    primitive(builder)["attributes"]["TEXCOORD_0"] = builder.accessor(square)
    places = read_materials(loaded(builder)).body.corners[..., :2].reshape(-1, 2)
    assert_allclose(places.min(axis=0), [0, 0.5], atol=1e-6)
    assert_allclose(places.max(axis=0), [0.5, 1], atol=1e-6)


def test_alpha_cuts_where_the_material_says(loaded):
    mask = {"alphaMode": "MASK", "alphaCutoff": 0.2, "pbr": {"baseColorFactor": [1, 1, 1, 0.4]}}
    assert read_materials(loaded(with_image(column(), **mask))).layers[0].cutoff == 0.5
    pbr = {"baseColorFactor": [1, 1, 1, 0.4]}
    blend = read_materials(loaded(with_image(column(), alphaMode="BLEND", pbr=pbr)))
    assert blend.layers == (Layer(0, blended=True),)
    assert (blend.body.opacity == 102).all()
    assert (blend.body.corners[..., 3] == BLENDED).all()
    opaque = read_materials(loaded(with_image(column(), pbr=pbr)))
    assert opaque.layers == (Layer(0),)
    assert (opaque.body.opacity == 255).all()


def test_alpha_of_vertices_counts_where_it_is_blended(loaded):
    colors = np.full((12, 4), 255, "u1")
    colors[:, 3] = np.linspace(0, 255, 12)
    builder = column()
    part = primitive(builder)
    part["attributes"]["COLOR_0"] = builder.accessor(colors, normalized=True)
    part["material"] = builder.add("materials", {**factor((1, 1, 1, 0.5)), "alphaMode": "BLEND"})
    result = read_materials(loaded(builder)).body.opacity
    assert_allclose(result, (colors[:, 3] / 2)[FACES], atol=1)


def test_the_same_image_is_listed_once_and_each_use_of_it(loaded):
    builder = with_image(column())
    pbr = builder.json["materials"][0]["pbrMetallicRoughness"]
    cut = builder.add("materials", {"pbrMetallicRoughness": pbr, "alphaMode": "MASK"})
    second_part(builder, FACES[:3], material=cut)
    second_part(builder, FACES[3:5])
    result = read_materials(loaded(builder))
    assert len(result.images) == 1
    assert result.layers == (Layer(0), Layer(0, cutoff=0.5))
    used = result.body.corners[:, 0, 2]
    assert_array_equal(used, [0] * len(FACES) + [1] * 3 + [0] * 2)


def test_older_materials_are_read_by_their_extension(loaded):
    builder = with_image(column())
    info = builder.json["materials"][0].pop("pbrMetallicRoughness")["baseColorTexture"]
    said = {"diffuseFactor": [0, 1, 0, 1], "diffuseTexture": info}
    name = "KHR_materials_pbrSpecularGlossiness"
    builder.json["materials"][0]["extensions"] = {name: said}
    result = read_materials(loaded(builder))
    assert (result.body.tints == (0, 255, 0)).all()
    assert (result.body.corners[..., 2] == 0).all()


def test_what_hangs_on_a_joint_is_coloured_too_also_mirrored(loaded):
    builder = column()
    attributes = {"POSITION": builder.positions(COLUMN)}
    sword = builder.mesh(attributes, name="sword")
    part = builder.json["meshes"][sword]["primitives"][0]
    part["material"] = builder.add("materials", factor(RED))
    colors = np.random.default_rng(4).integers(0, 256, (12, 4)).astype("u1")
    attributes["COLOR_0"] = builder.accessor(colors, normalized=True)
    builder.node(1, name="sword", mesh=sword, scale=[-1, 1, 1])
    rig = loaded(builder)
    faces = rig.attachments[0].mesh.faces
    assert_array_equal(faces, FACES[:, ::-1])
    (result,) = read_materials(rig).attachments
    assert_array_equal(result.tints, srgb(colors[faces][..., :3] / 255 * (1, 0, 0)))


def test_mended_faces_keep_their_materials(loaded):
    builder = with_image(column())
    second_part(builder, FACES[:5], material=builder.add("materials", factor(BLUE)))
    rig = loaded(builder)
    kept, turned = np.ones(len(rig.mesh.faces), bool), np.zeros(len(rig.mesh.faces), bool)
    kept[[0, 4]], turned[[2, 17]] = False, True
    mended = with_faces(rig, kept, turned)
    result = read_materials(mended).body
    textured = result.corners[:, 0, 2] == 0
    assert textured.sum() == len(FACES) - 2
    assert_allclose(result.corners[textured][..., :2], UV[mended.mesh.faces[textured]])
    assert (result.tints[~textured] == (0, 0, srgb(0.5))).all()


def test_joints_that_were_moved_change_no_material(loaded):
    rig = loaded(with_image(column()))
    moved = rig.with_joints(rig.skeleton.joints + 0.1)
    assert_array_equal(read_materials(moved).body.corners, read_materials(rig).body.corners)


def test_images_beside_the_document_are_read_when_they_are_wanted(tmp_path):
    builder = with_image(column())
    image = builder.json["images"][0]
    del image["bufferView"]
    image["uri"] = "skin.png"
    rig = cutcell.load(builder.save(tmp_path / "rig.gltf"))
    (note,) = read_materials(rig).notes
    assert "there is no such file" in note
    (tmp_path / "skin.png").write_bytes(b"beside")
    assert read_materials(rig).images[0].content == b"beside"
    image["uri"] = "../skin.png"
    (note,) = read_materials(cutcell.load(builder.save(tmp_path / "out.gltf"))).notes
    assert "is not a file in the folder" in note


def broken(change):
    builder = with_image(column(), pbr={"baseColorFactor": list(RED)}, name="cloth")
    change(builder.json, primitive(builder))
    return builder


BROKEN = {
    "no such texture": lambda json, part: json.update(textures=[]),
    "no such image": lambda json, part: json["textures"][0].update(source=7),
    "a format that is not read": lambda json, part: json["textures"][0].pop("source"),
    "an empty image": lambda json, part: json["bufferViews"][
        json["images"][0]["bufferView"]
    ].update(byteLength=0),
    "no coordinates": lambda json, part: part["attributes"].pop("TEXCOORD_0"),
    "coordinates of others": lambda json, part: json["accessors"][
        part["attributes"]["TEXCOORD_0"]
    ].update(count=3),
    "nonsense": lambda json, part: json["materials"][0]["pbrMetallicRoughness"].update(
        baseColorTexture=["one"]
    ),
}


@pytest.mark.parametrize("name", BROKEN)
def test_what_is_broken_is_told_and_leaves_the_factor(loaded, name):
    result = read_materials(loaded(broken(BROKEN[name])))
    (note,) = result.notes
    assert note.startswith('material "cloth" is used without')
    assert (result.body.tints == (255, 0, 0)).all()
    assert (result.body.corners[..., 2] == -1).all()


@pytest.mark.parametrize("wrong", [{"baseColorFactor": [1]}, {"baseColorFactor": "red"}])
def test_a_broken_factor_is_white(loaded, wrong):
    result = read_materials(loaded(with_image(column(), pbr=wrong)))
    assert len(result.notes) == 1
    assert (result.body.tints == 255).all()


def test_what_did_not_come_from_gltf_has_none(loaded):
    rig = loaded(with_image(column()))
    other = cutcell.Rig(rig.mesh, rig.skeleton, rig.weights)
    assert not has_materials(other)
    assert read_materials(other) is None
    mesh = cutcell.TriangleMesh(rig.mesh.vertices, rig.mesh.faces[:4])
    assert read_materials(replace(rig, mesh=mesh)) is None


def test_reading_leaves_the_document_as_it_was(loaded):
    rig = loaded(with_image(column()))
    read_materials(rig)
    assert rig.source.document.accessors == {}


ODD = [None, -1, 0, 3, 5125, 10**18, 0.5, 1e300, True, "", "x", [], [1], [None], {}, {"a": 1}]


def paths(value, path=()):
    """Return the way to each field below a value."""
    if not isinstance(value, dict | list):
        return
    for key in value if isinstance(value, dict) else range(len(value)):
        yield (*path, key)
        yield from paths(value[key], (*path, key))


def test_no_odd_field_is_an_error(loaded):
    def whole():
        transform = {"offset": [0, 1], "rotation": 1, "scale": [2, 2], "texCoord": 0}
        info = {"texCoord": 0, "extensions": {"KHR_texture_transform": transform}}
        material = {"alphaMode": "MASK", "alphaCutoff": 0.5, "name": "cloth"}
        sampler = {"wrapS": 33071, "magFilter": 9728}
        builder = with_image(column(), sampler=sampler, info=info, **material)
        attributes = primitive(builder)["attributes"]
        attributes["COLOR_0"] = builder.accessor(np.ones((12, 4), "f4"))
        return builder

    sound = whole().json
    kinds = ("materials", "textures", "images", "samplers")
    result = [path for kind in kinds for path in [(kind,), *paths(sound[kind], (kind,))]]
    part = ("meshes", 0, "primitives", 0)
    result += [
        (*part, "material"),
        *((*part, "attributes", f"{n}_0") for n in ("COLOR", "TEXCOORD")),
    ]
    assert len(result) > 25
    rig = loaded(whole())
    document = rig.source.document
    for path in result:
        *above, last = path
        owner = document.json
        for key in above:
            owner = owner[key]
        kept = owner[last]
        for value in ODD:
            owner[last] = value
            has_materials(rig)
            materials = read_materials(rig)
            assert np.isfinite(materials.body.corners).all(), (path, value)
        owner[last] = kept
    assert read_materials(rig).notes == ()


class TestWithoutASkin:
    @pytest.fixture
    def bare(self):
        """Return the column without its skin, with an image; two nodes show it, one mirrored."""
        builder = with_image(column())
        node = next(one for one in builder.json["nodes"] if "mesh" in one)
        del node["skin"], builder.json["skins"], builder.json["nodes"][0]["children"]
        for name in ("JOINTS_0", "WEIGHTS_0"):
            del primitive(builder)["attributes"][name]
        builder.node(mesh=0, scale=[-1, 1, 1], translation=[4, 0, 0])
        return builder

    def test_its_materials_are_read(self, loaded, bare):
        rig = loaded(bare)
        assert len(rig.skeleton.joints) == 0
        assert has_materials(rig)
        result = read_materials(rig)
        expected = np.concatenate([UV[FACES], UV[FACES[:, ::-1]]])
        assert_allclose(result.body.corners[..., :2], expected)
        assert len(result.layers) == 1

    def test_a_skeleton_and_a_repair_keep_them(self, loaded, bare):
        rig = loaded(bare)
        joints = cutcell.Skeleton([[0.5, 0, 0.5], [0.5, 1, 0.5]], [-1, 0])
        rig = replace(rig, skeleton=joints)
        kept, turned = np.ones((2, 2 * len(FACES)), bool)
        kept[[0, 20]] = False
        turned[:] = False
        turned[3] = True
        repaired = with_faces(rig, kept, turned)
        expected = np.concatenate([UV[FACES], UV[FACES[:, ::-1]]])
        expected[3] = expected[3, [0, 2, 1]]
        result = read_materials(repaired)
        assert_allclose(result.body.corners[..., :2], expected[kept])
        whole = with_faces(repaired, np.ones(kept.sum(), bool), np.zeros(kept.sum(), bool))
        assert_allclose(read_materials(whole).body.corners, result.body.corners)
