"""Channels of KHR_animation_pointer on nodes are those of the core; others are reported."""

import copy

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

import cutcell
from cutcell.io.gltf.nodes import target_of
from tests.cutcell.io.gltf.gltf_builder import REST, column
from tests.cutcell.io.gltf.test_gltf_clips import animate
from tests.cutcell.io.gltf.test_gltf_moves import waving


def pointed(builder):
    """Address the channels of a builder by pointers."""
    other = copy.deepcopy(builder)
    for animation in other.json["animations"]:
        for channel in animation["channels"]:
            node, path = channel["target"]["node"], channel["target"]["path"]
            channel["target"] = target(f"/nodes/{node}/{path}")
    return other


def target(pointer):
    return {"path": "pointer", "extensions": {"KHR_animation_pointer": {"pointer": pointer}}}


def both(loaded, how="LINEAR"):
    builder, _ = waving(how)
    return loaded(builder, "core.glb"), loaded(pointed(builder), "pointer.glb")


@pytest.mark.parametrize("how", ["LINEAR", "CUBICSPLINE", "STEP"])
def test_clips_are_the_same_also_after_joints_moved(loaded, tmp_path, how):
    for place in (REST, REST + np.array([[0.1, 0.2, 0.0], [0.0, -0.3, 0.25]])):
        clips = []
        for rig in both(loaded, how):
            cutcell.save(tmp_path / "out.glb", rig.with_joints(place))
            again = cutcell.load(tmp_path / "out.glb")
            assert again.warnings == ()
            assert_allclose(again.skeleton.joints, place, atol=1e-6)
            clips.append(again.clips[0])
        seconds = np.linspace(0, 1, 7)
        assert_array_equal(clips[0].sample(seconds), clips[1].sample(seconds))


def test_the_channels_of_a_removed_joint_go_with_it(loaded, tmp_path):
    for rig in both(loaded):
        other = cutcell.edited_rig(rig, cutcell.Edits(removed=("tip",)))
        cutcell.save(tmp_path / "out.glb", other.with_weights(np.ones((12, 1))))
        animations = cutcell.load(tmp_path / "out.glb").source.document.json["animations"]
        channels = [channel for one in animations for channel in one["channels"]]
        assert [target_of(channel) for channel in channels] == [(0, "rotation")]


def test_nodes_that_move_meshes_are_seen_by_pointers_too(loaded):
    builder = column()
    del builder.json["nodes"][2]["skin"]
    del builder.json["skins"]
    animate(builder, (2, "translation", [0, 1], [[0, 0, 0], [1, 0, 0]], "LINEAR"))
    builder.json["nodes"][0]["mesh"] = builder.mesh()
    reasons = [loaded(one).warnings for one in (builder, pointed(builder))]
    assert "move them rigidly" in reasons[0][0]
    assert reasons[0] == reasons[1]


@pytest.mark.parametrize(
    "pointer",
    [
        "/materials/0/pbrMetallicRoughness/baseColorFactor",
        "/nodes/0/extensions/KHR_node_visibility/visible",
        "/nodes/01/translation",
        "/nodes/-1/translation",
        f"/nodes/{'9' * 5000}/translation",
    ],
)
def test_other_pointers_are_kept_and_reported_once(loaded, tmp_path, pointer):
    builder, _ = waving()
    other = {"sampler": 2, "target": target(pointer)}
    builder.json["animations"][0]["channels"] += [other, other]
    rig = loaded(builder)
    (warning,) = rig.warnings
    assert warning.startswith("animations of other properties than nodes have are not read")
    assert pointer[:40] in warning
    assert len(warning) < 250
    cutcell.save(tmp_path / "out.glb", rig.with_joints(REST + 0.1))
    again = cutcell.load(tmp_path / "out.glb")
    assert again.warnings == rig.warnings
    channels = again.source.document.json["animations"][0]["channels"]
    assert [channel["target"] for channel in channels[-2:]] == [target(pointer)] * 2
