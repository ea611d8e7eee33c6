"""Joints that were moved are saved where they are, and nothing else changes what it means."""

import json
from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

import cutcell
from cutcell.errors import SkeletonError
from cutcell_assets import demo_path
from tests.cutcell.io.gltf.gltf_builder import REST, column, moved, two_skins
from tests.cutcell.io.gltf.test_gltf_clips import animate, quaternions, scene_vertices
from tests.cutcell.io.gltf.test_gltf_save import without_deform
from tests.gltf_validator.validator import errors, reports

DEMO = ("biped.glb", "robot.glb", "octopus.glb")
REAL = ("kaykit_knight.glb", "makehuman_clothed_mixamo.glb")


def with_some_moved(rig, seed=3):
    """Return a rig with a third of its joints moved, and its size."""
    rng = np.random.default_rng(seed)
    size = np.ptp(rig.mesh.bounds, axis=0).max()
    some = rng.random(len(rig.skeleton.joints)) < 0.35
    some[1] = True
    joints = rig.skeleton.joints + 0.03 * size * rng.standard_normal((len(some), 3)) * some[:, None]
    return rig.with_joints(joints), size


def check_moved(path, out):
    rig = cutcell.load(path)
    other, size = with_some_moved(rig)
    cutcell.save(out, other)
    again = cutcell.load(out)
    assert_allclose(again.skeleton.joints, other.skeleton.joints, atol=1e-6 * size)
    assert_allclose(again.weights, rig.weights, atol=2e-7)
    assert_array_equal(again.mesh.vertices, rig.mesh.vertices)
    assert_allclose(again.skeleton.orientations, rig.skeleton.orientations, atol=1e-6)
    for a, b in zip(again.attachments, rig.attachments, strict=True):
        assert_allclose(a.mesh.vertices, b.mesh.vertices, atol=1e-5 * size)
    assert again.skeleton.names == rig.skeleton.names
    for a, b in zip(again.clips, other.clips, strict=True):
        when = np.linspace(0, b.duration, 5)
        assert_allclose(a.sample(when), b.sample(when), atol=2e-5 * max(size, 1))
    check_nothing_else_changed(rig.source.document.json, again.source.document.json)
    size_now = out.stat().st_size
    cutcell.save(out, again)
    assert out.stat().st_size == size_now
    assert_array_equal(cutcell.load(out).skeleton.joints, again.skeleton.joints)
    before, after = (errors(report) for report in reports(path, out))
    assert not after - before


def check_nothing_else_changed(before, after):
    before, after = (json.loads(json.dumps(one)) for one in (before, after))
    for one in (before, after):
        for key in ("accessors", "bufferViews", "buffers", "meshes"):
            one.pop(key, None)
        for node in one["nodes"]:
            node.pop("translation", None)
            node.pop("matrix", None)
        for animation in one.get("animations", []):
            for channel in animation["channels"]:
                given = animation["samplers"][channel.pop("sampler")]
                channel |= {k: v for k, v in given.items() if k != "output"}
            animation.pop("samplers")
        one["skins"] = without_deform(one["skins"])
        for skin in one["skins"]:
            skin.pop("inverseBindMatrices", None)
    assert before == after


@pytest.mark.parametrize("name", DEMO)
def test_moved_joints_of_the_demos_are_saved(demo_paths, tmp_path, name):
    check_moved(demo_paths[0].with_name(name), tmp_path / "out.glb")


@pytest.mark.parametrize("name", REAL)
def test_moved_joints_of_real_characters_are_saved(rigs, tmp_path, name):
    check_moved(rigs[0].with_name(name), tmp_path / "out.glb")


def waving(how="LINEAR"):
    """Return the column with both joints turned and the tip shifted, and its channels."""
    builder = column()
    place = np.array([[0, 1, 0], [0, 1.5, 0.25]])
    if how == "CUBICSPLINE":
        place = np.stack([np.zeros((2, 3)), place, np.ones((2, 3))], axis=1).reshape(-1, 3)
    channels = [
        (0, "rotation", [0, 1], quaternions(0, 90), "LINEAR"),
        (1, "rotation", [0, 1], quaternions(0, 40, axis="x"), "LINEAR"),
        (1, "translation", [0, 1], place, how),
    ]
    animate(builder, *channels)
    return builder, channels


@pytest.mark.parametrize("how", ["LINEAR", "CUBICSPLINE", "STEP"])
def test_a_moved_joint_turns_about_its_new_place(loaded, tmp_path, how):
    builder, channels = waving(how)
    rig = loaded(builder)
    by = np.array([[0.1, 0.2, 0.0], [0.0, -0.3, 0.25]])
    cutcell.save(tmp_path / "out.glb", rig.with_joints(REST + by))
    again = cutcell.load(tmp_path / "out.glb")
    # The same, written anew by hand.
    wanted, _ = waving(how)
    wanted.json["nodes"][0]["translation"] = (REST[0] + by[0]).tolist()
    wanted.json["nodes"][1]["translation"] = (REST[1] + by[1] - REST[0] - by[0]).tolist()
    keys = np.array(channels[2][3])
    keys[slice(1, None, 3) if how == "CUBICSPLINE" else slice(None)] += by[1] - by[0]
    channels = [*channels[:2], (*channels[2][:3], keys, how)]
    inverse = [moved(*-p) for p in REST + by]
    for t in (0, 0.3, 1):
        matrices = again.clips[0].sample(t)
        points = np.einsum("jab,nb->nja", matrices[:, :3, :3], rig.mesh.vertices)
        points = ((points + matrices[:, :3, 3]) * rig.weights[..., None]).sum(axis=1)
        assert_allclose(points, scene_vertices(wanted, channels, t, inverse), atol=1e-5)


def test_frames_and_channels_move_alike(loaded):
    rig = loaded(waving()[0])
    clip = rig.clips[0]
    frames = cutcell.Clip("frames", clip.times, clip.transforms)
    by = np.array([[0.1, 0.2, 0.0], [0.0, -0.3, 0.25]])
    both = replace(rig, clips=(clip, frames)).with_joints(REST + by)
    assert_allclose(both.clips[0].transforms, both.clips[1].transforms, atol=1e-6)
    back = both.with_joints(REST)
    assert_allclose(back.clips[0].transforms, clip.transforms, atol=1e-9)
    assert_allclose(back.clips[1].transforms, clip.transforms, atol=1e-9)
    hidden = cutcell.Clip("hidden", [0.0], np.zeros((1, 2, 4, 4)))
    assert np.isfinite(
        replace(rig, clips=(hidden,)).with_joints(REST + by).clips[0].sample(0)
    ).all()


def test_what_others_use_is_left_to_them(loaded, tmp_path):
    builder, _ = waving()
    animation = builder.json["animations"][0]
    lamp = builder.node(1, name="lamp", translation=[0, 0, 0.5])
    animation["channels"] += [
        {"sampler": 2, "target": {"node": lamp, "path": "translation"}},
        {"sampler": 2, "target": {"node": 1, "path": "scale"}},
    ]
    rig = loaded(builder)
    cutcell.save(tmp_path / "out.glb", rig.with_joints(REST + np.array([[0, 0, 0], [0, 0.5, 0]])))
    document = cutcell.load(tmp_path / "out.glb").source.document.json
    assert_allclose(document["nodes"][lamp]["translation"], [0, -0.5, 0.5])
    channels, samplers = (document["animations"][0][key] for key in ("channels", "samplers"))
    outputs = [samplers[channel["sampler"]]["output"] for channel in channels]
    assert outputs[4] == builder.json["animations"][0]["samplers"][2]["output"]
    assert len({*outputs[2:]}) == 3


@pytest.mark.parametrize("shared", [True, False])
def test_every_skin_follows(loaded, tmp_path, shared):
    rig = loaded(two_skins([0, 0, 3], shared))
    joints = rig.skeleton.joints + 0.125 * np.arange(3 * len(rig.skeleton.joints)).reshape(-1, 3)
    cutcell.save(tmp_path / "out.glb", rig.with_joints(joints))
    again = cutcell.load(tmp_path / "out.glb")
    assert_allclose(again.skeleton.joints, joints, atol=1e-6)
    if shared:  # else the first skin's root says where the second one's space is
        assert_allclose(again.mesh.vertices, rig.mesh.vertices, atol=1e-6)


def test_nodes_with_matrices_and_scaled_ones_are_shifted_in_their_own_units(loaded, tmp_path):
    builder = column()
    root, tip = builder.json["nodes"][:2]
    root["scale"] = [0.5, 0.5, 0.5]
    tip["translation"] = [0, 2, 0]
    tip["matrix"] = moved(*tip.pop("translation")).T.ravel().tolist()
    doubled = np.diag([2.0, 2.0, 2.0, 1.0])
    builder.json["skins"][0]["inverseBindMatrices"] = builder.accessor(
        np.array([doubled @ moved(*-p) for p in REST])
    )
    rig, by = loaded(builder), np.array([[0.25, 0, 0], [0, 0, 0.25]])
    cutcell.save(tmp_path / "out.glb", rig.with_joints(REST + by))
    again = cutcell.load(tmp_path / "out.glb")
    assert_allclose(again.skeleton.joints, REST + by, atol=1e-6)
    assert_allclose(again.world, rig.world, atol=1e-6)
    assert_allclose(again.source.document.json["nodes"][1]["matrix"][12:15], [-0.5, 2, 0.5])


def test_other_formats_hold_them_too(loaded, tmp_path):
    rig = loaded(waving()[0]).with_joints(REST + 0.25)
    for name, clips in (("a.npz", 0), ("a.txt", 0)):
        cutcell.save(tmp_path / name, rig)
        again = cutcell.load(tmp_path / name)
        assert_array_equal(again.skeleton.joints, REST + 0.25)
        assert len(again.clips) == clips
    cutcell.save(tmp_path / "new.glb", replace(rig, source=None))
    again = cutcell.load(tmp_path / "new.glb")
    assert_allclose(again.skeleton.joints, REST + 0.25, atol=1e-6)
    assert_allclose(again.clips[0].sample(0.5), rig.clips[0].sample(0.5), atol=1e-5)


def test_what_cannot_be_moved_is_refused(loaded, tmp_path):
    builder = column()
    del builder.json["skins"][0]["inverseBindMatrices"]
    rig = loaded(builder)
    cutcell.save(tmp_path / "a.glb", rig)
    with pytest.raises(SkeletonError, match="has no inverse bind matrices"):
        cutcell.save(tmp_path / "a.glb", rig.with_joints(rig.skeleton.joints + 1))
    rig = loaded(column())
    with pytest.raises(SkeletonError, match="not a finite number"):
        rig.with_joints(REST * np.nan)
    with pytest.raises(SkeletonError, match="times the mesh's size away"):
        rig.with_joints(REST + 1000)
    other = replace(rig, skeleton=replace(rig.skeleton, parents=[-1, -1]))
    with pytest.raises(SkeletonError, match="no longer those of its document"):
        cutcell.save(tmp_path / "a.glb", other)
    assert rig.with_joints(REST) is rig


def test_joints_that_were_renamed_are_called_so(tmp_path):
    rig = cutcell.load(demo_path("robot"))
    name = rig.skeleton.names[2]
    new = cutcell.JointEdit(was=name, position=tuple(rig.skeleton.joints[2] + 0.01))
    other = cutcell.edited_rig(rig, cutcell.Edits({"new name": new}))
    cutcell.save(tmp_path / "renamed.glb", other)
    again = cutcell.load(tmp_path / "renamed.glb")
    assert again.skeleton.names[2] == "new name"
    assert again.skeleton.names[3:] == rig.skeleton.names[3:]
    assert_allclose(again.skeleton.joints, other.skeleton.joints, atol=1e-6)
    assert_allclose(again.weights, rig.weights, atol=2e-7)
    assert not errors(reports(tmp_path / "renamed.glb")[0])
    gone = cutcell.edited_rig(rig, cutcell.Edits(removed=[name]))
    for ending in ("glb", "npz"):
        cutcell.save(tmp_path / f"gone.{ending}", gone)
        assert name not in cutcell.load(tmp_path / f"gone.{ending}").skeleton.names
