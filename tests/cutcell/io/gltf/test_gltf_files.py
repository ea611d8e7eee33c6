"""Documents that move: between .glb and .gltf, with buffers and images of their own."""

import json
import os

import pytest
from numpy.testing import assert_allclose

import cutcell
from cutcell.io.gltf.container import read_document
from tests.cutcell.io.gltf.gltf_builder import column
from tests.cutcell.io.gltf.test_gltf_save import (
    check_nothing_else_changed,
    check_round_trip,
    random_weights,
)
from tests.gltf_validator.validator import errors, reports


def test_from_binary_to_text_and_back(tmp_path):
    rig = cutcell.load(column().save(tmp_path / "in.glb"))
    weights = random_weights(rig, 2)
    (tmp_path / "there").mkdir()
    text, binary = tmp_path / "there" / "a#b.gltf", tmp_path / "back.glb"
    cutcell.save(text, rig.with_weights(weights))
    assert sorted(os.listdir(text.parent)) == ["a#b.bin", "a#b.gltf"]
    assert errors(reports(text)[0]) == {}
    cutcell.save(binary, cutcell.load(text))
    for path in (text, binary):
        assert_allclose(cutcell.load(path).weights, weights, atol=1e-7)
    assert errors(reports(binary)[0]) == {}
    check_nothing_else_changed(read_document(tmp_path / "in.glb"), read_document(binary))


def test_several_buffers_become_one(tmp_path):
    builder = column()
    document = builder.finished()
    half = document["bufferViews"][3]["byteOffset"]
    data = bytes(builder.data)
    document["buffers"] = [
        {"uri": "first.bin", "byteLength": half, "extras": {"kept": True}},
        {"uri": "second.bin", "byteLength": len(data) - half},
    ]
    for view in document["bufferViews"][3:]:
        view |= {"buffer": 1, "byteOffset": view["byteOffset"] - half}
    (tmp_path / "first.bin").write_bytes(data[:half])
    (tmp_path / "second.bin").write_bytes(data[half:])
    (tmp_path / "in.gltf").write_text(json.dumps(document))
    check_round_trip(tmp_path / "in.gltf", tmp_path / "out.gltf", 2)
    check_round_trip(tmp_path / "in.gltf", tmp_path / "out.glb", 2)
    assert read_document(tmp_path / "out.gltf").json["buffers"][0]["extras"] == {"kept": True}
    assert errors(reports(tmp_path / "out.gltf")[0]) == {}


@pytest.fixture
def pictured(tmp_path):
    """Give a .gltf with an image in a file of its own, in a subfolder, and one that is missing."""
    from PIL import Image

    builder = column()
    (tmp_path / "in" / "textures").mkdir(parents=True)
    Image.new("RGB", (4, 4), "teal").save(tmp_path / "in" / "textures" / "a b.png")
    builder.json["images"] = [{"uri": "textures/a%20b.png"}, {"uri": "gone.png"}]
    builder.json["textures"] = [{"source": 0}, {"source": 1}]
    return builder.save(tmp_path / "in" / "rig.gltf")


def test_images_go_along_when_text_moves(tmp_path, pictured):
    (tmp_path / "out").mkdir()
    cutcell.save(tmp_path / "out" / "rig.gltf", cutcell.load(pictured))
    copied = tmp_path / "out" / "textures" / "a b.png"
    assert copied.read_bytes() == (tmp_path / "in" / "textures" / "a b.png").read_bytes()
    copied.write_bytes(b"another picture")
    with pytest.raises(cutcell.FileError, match=r"image textures/a%20b\.png would replace another"):
        cutcell.save(tmp_path / "out" / "rig.gltf", cutcell.load(pictured))


def test_images_are_taken_into_a_binary_file(tmp_path, pictured):
    cutcell.save(tmp_path / "in" / "rig.glb", cutcell.load(pictured))
    document = read_document(tmp_path / "in" / "rig.glb")
    image, gone = document.items("images")
    assert image["mimeType"] == "image/png"
    assert image["name"] == "a b"
    assert gone == {"uri": "gone.png"}
    view = document.json["bufferViews"][image["bufferView"]]
    start = view["byteOffset"]
    picture = document.buffers[0][start : start + view["byteLength"]]
    assert picture == (tmp_path / "in" / "textures" / "a b.png").read_bytes()


def test_images_of_one_file_are_taken_in_once(tmp_path, pictured):
    document = json.loads(pictured.read_text())
    document["images"] += document["images"][:1] * 20
    pictured.write_text(json.dumps(document))
    cutcell.save(tmp_path / "out.glb", cutcell.load(pictured))
    images = read_document(tmp_path / "out.glb").items("images")
    assert len({image["bufferView"] for image in images if "bufferView" in image}) == 1
    assert len(images) == 22


def test_a_binary_file_keeps_its_image_beside_it_until_it_moves(tmp_path, pictured):
    document = json.loads(pictured.read_text())
    builder = column()
    builder.json |= {"images": document["images"][:1], "textures": [{"source": 0}]}
    path = builder.save(pictured.parent / "rig.glb")
    cutcell.save(pictured.parent / "again.glb", cutcell.load(path))
    cutcell.save(tmp_path / "moved.glb", cutcell.load(path))
    images = [
        read_document(p).items("images")[0]
        for p in (pictured.parent / "again.glb", tmp_path / "moved.glb")
    ]
    assert images[0] == {"uri": "textures/a%20b.png"}
    assert "bufferView" in images[1]
