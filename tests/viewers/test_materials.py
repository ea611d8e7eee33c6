"""Materials in pictures: images decoded within bounds, and each pixel the colour of its place."""

import struct
import zlib
from dataclasses import replace

import numpy as np
import pytest

import cutcell
from cutcell.io.materials.face_colors import Layer, StoredImage
from cutcell.io.materials.transfer import read_materials
from cutcell_viewers.camera import Camera
from cutcell_viewers.character import body
from cutcell_viewers.description import Description
from cutcell_viewers.materials import (
    MAX_LAYERS,
    MAX_PIXELS,
    as_textures,
    decoded,
    load_textures,
    none_decoded,
)
from cutcell_viewers.scene import Scene
from tests.viewers.textures import png, seen, squares, wall

FRONT = Camera((0, 0, 4), (0, 0, 0))


@pytest.fixture
def rig_of(tmp_path):
    return lambda builder: cutcell.load(builder.save(tmp_path / "wall.glb"))


def images(*contents):
    return [StoredImage(f"image {k}", content) for k, content in enumerate(contents)]


def one(content, **use):
    pixels, problems = decoded(images(content), [Layer(0, **use)])
    assert problems == {}
    return pixels[0]


def hue(color):
    """Return which of red, green and blue a colour has, however light it is."""
    color = np.asarray(color, float)
    return tuple((color > 0.6 * color.max()).tolist())


@pytest.mark.parametrize("kind", ["PNG", "JPEG", "WEBP", "BMP", "TGA"])
def test_images_become_layers_of_one_size(kind):
    pixels, problems = decoded(
        images(png(squares(200), kind), png(squares(32), kind)), [Layer(0), Layer(1)]
    )
    assert problems == {}
    assert pixels.shape == (2, 256, 256, 4)
    for layer in pixels:
        at = layer[[64, 64, 192, 192], [64, 192, 64, 192], :3]
        assert np.abs(at.astype(int) - squares(2).reshape(4, 3)).max() < 12
    assert (pixels[..., 3] == 255).all()


def test_large_images_become_smaller_and_many_become_smaller_still():
    large = png(squares(2000))
    pixels, _ = decoded(images(large), [Layer(0)])
    assert pixels.shape[1] == 1024
    many = [Layer(0, cutoff=k / 100) for k in range(20)]
    pixels, _ = decoded(images(large), many)
    assert pixels.shape[1] == 512
    assert pixels.size <= 4 * MAX_PIXELS
    more = [Layer(0, cutoff=k / 100) for k in range(MAX_LAYERS + 3)]
    pixels, problems = decoded(images(png(squares(4))), more)
    assert len(pixels) == MAX_LAYERS
    assert sorted(problems) == list(range(MAX_LAYERS, MAX_LAYERS + 3))


def test_squares_stay_squares_where_the_file_wants_them():
    def colors(pixels):
        return {tuple(color) for color in pixels[..., :3].reshape(-1, 3).tolist()}

    content = png(squares(2))
    assert colors(one(content, nearest=True)) == colors(squares(2))
    assert len(colors(one(content))) > 20


def test_alpha_is_cut_at_a_half_and_colours_do_not_fade_there():
    pixels = np.full((128, 128, 4), (200, 100, 50, 0), np.uint8)
    pixels[:, 64:, 3] = 90  # a third
    assert (one(png(pixels))[..., 3] == 255).all()
    cut = one(png(pixels), cutoff=0.3)
    assert (cut[:, 70:, 3] >= 128).all()
    assert (cut[:, :58, 3] < 128).all()
    assert (cut[..., :3] == (200, 100, 50)).all()
    assert (one(png(pixels), cutoff=0.5)[..., 3] < 128).all()
    blended = one(png(pixels), blended=True)[..., 3]
    assert (blended[:, 70:] == 90).all()
    assert (blended[:, :58] == 0).all()


def huge():
    """Return an image that announces a billion pixels in a few bytes."""

    def chunk(name, content):
        check = struct.pack(">I", zlib.crc32(name + content))
        return struct.pack(">I", len(content)) + name + content + check

    head = struct.pack(">IIBBBBB", 40_000, 30_000, 8, 2, 0, 0, 0)
    return b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", head) + chunk(b"IDAT", b"") + chunk(b"IEND", b"")


@pytest.mark.parametrize(
    ("content", "why"),
    [
        (b"no image at all", "no PNG, JPEG, WebP, BMP or TGA, or damaged"),
        (b"\xabKTX 20\xbb\r\n\x1a\n" + bytes(80), "no PNG, JPEG, WebP"),
        (png(squares(64))[:90], "damaged"),
        (huge(), "67 million"),
    ],
)
def test_an_image_that_cannot_be_shown_leaves_the_factor_and_is_told(rig_of, content, why):
    rig = rig_of(wall(content, pbr={"baseColorFactor": [0, 1, 0, 1]}))
    result = load_textures(rig)
    (note,) = result.notes
    assert note.startswith('image "wall" cannot be shown: ')
    assert why in note
    assert (result.body.corners[..., 2] == -1).all()
    assert (result.body.tints == (0, 255, 0)).all()


def test_where_decoding_ends_all_layers_are_told(rig_of):
    rig = rig_of(wall(png(squares())))
    materials = read_materials(rig)
    result = as_textures(rig, materials, *none_decoded(materials.layers, "it ended"))
    assert result.notes == ('image "wall" cannot be shown: it ended',)
    assert (result.body.corners[..., 2] == -1).all()


def test_corners_turn_with_the_faces_of_a_mirrored_space(rig_of):
    rig = rig_of(wall(png(squares())))
    mirrored = replace(rig, world=np.diag([-1.0, 1, 1, 1]))
    given, turned = load_textures(rig).body, load_textures(mirrored).body
    np.testing.assert_array_equal(turned.corners, given.corners[:, ::-1])
    np.testing.assert_array_equal(body(mirrored).cells, body(rig).cells[:, ::-1])


def picture(rig, pose=None):
    result = load_textures(rig)
    scene = Scene(size=(200, 200))
    try:
        actors = {"body": body(rig, materials=result.body)}
        scene.show(Description(actors, images=result.images, pose=pose))
        scene.set_camera(FRONT)
        return scene.render_png()
    finally:
        scene.close()


def at(pixels, x, y):
    """Return the pixel of a place of the wall's front, -1 to 1 each."""
    half = 100 / (np.tan(np.radians(15)) * 3.8)  # the camera sees 30 degrees
    return pixels[round(100 - half * y), round(100 + half * x)]


SAMPLERS = [
    {},
    {"wrapS": 33071, "wrapT": 33071},
    {"wrapS": 33648, "wrapT": 33648},
]


@pytest.mark.parametrize("sampler", SAMPLERS)
def test_each_pixel_has_the_colour_of_its_place_in_the_image(rig_of, sampler):
    low, high = (-0.75, -0.75), (1.75, 1.75)
    pixels = picture(rig_of(wall(png(squares()), low, high, sampler)))
    for x in (-0.9, -0.55, 0.12, 0.6, 0.93):
        for y in (-0.9, -0.5, -0.1, 0.45, 0.9):
            u, v = 0.5 + 1.25 * x, 0.5 - 1.25 * y
            assert hue(at(pixels, x, y)) == hue(seen(u, v, sampler)), (x, y)


def test_nothing_is_drawn_where_the_image_is_not_there(rig_of):
    pixels = np.dstack([squares(), np.full((64, 64), 255, np.uint8)])
    pixels[:, :32, 3] = 0
    rig = rig_of(wall(png(pixels), alphaMode="MASK"))
    drawn = picture(rig).astype(int)
    empty = drawn[100, 0]
    assert np.abs(at(drawn, 0.5, 0.5) - empty).max() > 60
    # What is seen through it is the wall's back, where that is cut as well.
    assert np.abs(at(drawn, -0.5, 0.0) - at(drawn, -0.5, 0.05)).max() < 5
    assert np.abs(at(drawn, -0.5, 0.0) - empty).max() < 5


def test_what_is_cut_has_no_half_transparent_edge(rig_of):
    pixels = np.full((128, 128, 4), (255, 0, 0, 255), np.uint8)
    pixels[..., 3] = np.linspace(0, 255, 128)
    drawn = picture(rig_of(wall(png(pixels), alphaMode="MASK"))).astype(int)[100]
    red = drawn[6:194, 0] - drawn[6:194, 1] > 60
    seen = drawn[6:194][red]
    assert 80 < red.sum() < 110
    assert np.ptp(seen[3:-3, 1]) < 40, "no lighter towards the edge"


@pytest.mark.parametrize("inside", [True, False])
def test_as_many_pixels_are_drawn_as_alpha_says(rig_of, inside):
    pixels = np.dstack([squares(), np.full((64, 64), 128 if inside else 255, np.uint8)])
    alpha = 0.5 if inside else 0.25
    pbr = {} if inside else {"baseColorFactor": [1, 1, 1, 0.25]}
    drawn = picture(rig_of(wall(png(pixels), alphaMode="BLEND", pbr=pbr))).astype(int)
    part = drawn[60:92, 60:92]  # red, in front of the same in the wall's back
    strong = part[..., 0] - part[..., 1] > 60
    # The wall's back is drawn at the same pixels: nothing is sorted, nothing adds up.
    assert abs(strong.mean() - alpha) < 0.1


def test_alpha_counts_without_an_image_too(rig_of):
    builder = wall(png(squares()), alphaMode="BLEND", pbr={"baseColorFactor": [1, 0, 0, 0.5]})
    del builder.json["materials"][0]["pbrMetallicRoughness"]["baseColorTexture"]
    part = picture(rig_of(builder)).astype(int)[60:140, 60:140]
    strong = part[..., 0] - part[..., 1] > 60
    assert 0.4 < strong.mean() < 0.8


def test_the_image_moves_with_the_body(rig_of):
    rig = rig_of(wall(png(squares())))
    pose = np.stack([np.eye(4), np.eye(4)])
    pose[1, 1, 3] = -0.5  # the upper edge comes down
    pixels = picture(rig, pose)
    assert hue(at(pixels, -0.5, 0.2)) == hue(seen(0.25, 0.2))
    assert hue(at(pixels, 0.5, -0.8)) == hue(seen(0.75, 0.87))
