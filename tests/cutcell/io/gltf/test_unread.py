"""What a document has and nobody reads is said once; what saving needs is checked by loading."""

import json

import numpy as np
import pytest

import cutcell
from tests.cutcell.io.gltf.gltf_builder import COLUMN, column, moved, pack
from tests.cutcell.io.gltf.test_gltf_clips import FLIPPED, animate


def test_morph_targets_are_reported_once(loaded, tmp_path):
    builder = column()
    targets = [{"POSITION": builder.positions(COLUMN * 0.1)}] * 2
    primitive = builder.json["meshes"][0]["primitives"][0]
    primitive["targets"] = targets
    builder.json["meshes"][0]["primitives"] *= 2
    rig = loaded(builder)
    (warning,) = rig.warnings
    assert warning.startswith('morph targets are not read (mesh "column")')
    cutcell.save(tmp_path / "out.glb", rig)
    document = cutcell.load(tmp_path / "out.glb").source.document
    assert document.json["meshes"][0]["primitives"][0]["targets"] == targets


@pytest.mark.parametrize("is_bare", [False, True])
def test_extensions_that_a_file_requires_are_reported_if_they_are_not_read(loaded, is_bare):
    builder = column()
    if is_bare:
        del builder.json["nodes"][2]["skin"], builder.json["skins"]
        builder.json["nodes"][0]["mesh"] = builder.mesh()
    builder.json["extensionsRequired"] = [
        "KHR_mesh_quantization", "KHR_materials_unlit", "EXT_texture_webp", "KHR_animation_pointer",
        "EXT_lights_image_based", "VRMC_vrm", "FUTURE_curves",
    ]  # fmt: skip
    (warning,) = [text for text in loaded(builder).warnings if "extensions" in text]
    assert warning.startswith("required extensions are not read (FUTURE_curves)")


def far_view(builder):
    builder.add("bufferViews", {"buffer": 0, "byteOffset": 10**9, "byteLength": 4})


def odd_view(builder):
    builder.add("bufferViews", {"buffer": 0, "byteOffset": [], "byteLength": 4})


def no_buffer(builder):
    builder.add("bufferViews", {"buffer": 10**30, "byteLength": 4})


def in_an_extension(builder):
    builder.json["extensions"] = {"A_b": {"buffer": 0, "byteLength": 10**9}}


def no_images(builder):
    builder.json["images"] = None


def unused_skin(builder):
    builder.skin([99])


def unused_matrices(builder):
    builder.skin([0, 1], [moved(0, 0, 0)] * 2)
    builder.json["skins"][-1]["inverseBindMatrices"] = builder.accessor(COLUMN)


def sampler_of_another_node(builder):
    animate(builder, *FLIPPED)
    channel = {"sampler": 9, "target": {"node": 2, "path": "scale"}}
    builder.json["animations"][0]["channels"].append(channel)


def values_of_another_node(builder):
    animate(builder, (2, "translation", [0, 1], [[0, 0, 0, 1]] * 2, "LINEAR"))


def another_node(builder):
    animate(builder, (99, "translation", [0, 1], np.zeros((2, 3)), "LINEAR"))


@pytest.mark.parametrize(
    "damage",
    [
        far_view, odd_view, no_buffer, in_an_extension, no_images, unused_skin, unused_matrices,
        sampler_of_another_node, values_of_another_node, another_node,
    ],
)  # fmt: skip
@pytest.mark.parametrize("is_bare", [False, True])
def test_what_saving_would_refuse_is_refused_by_loading(loaded, damage, is_bare):
    builder = column()
    if is_bare:
        builder.json["nodes"][0]["mesh"] = builder.mesh()
        del builder.json["nodes"][2]["skin"], builder.json["skins"]
    damage(builder)
    with pytest.raises(cutcell.CutcellError, match=r"^rig\.glb: "):
        loaded(builder)


@pytest.mark.parametrize("number", ["1e400", "-1E+999", "1" * 310 + ".0"])
def test_a_number_that_json_cannot_hold_is_refused_by_loading(tmp_path, number):
    builder = column()
    builder.json["extras"] = "many"
    text = json.dumps(builder.finished()).replace('"many"', number).encode()
    (tmp_path / "rig.glb").write_bytes(pack(text, bytes(builder.data)))
    with pytest.raises(cutcell.FileError, match="is not a JSON number"):
        cutcell.load(tmp_path / "rig.glb")
