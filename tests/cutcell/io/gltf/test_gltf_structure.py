"""Skeletons with other joints than their file's are saved into it, and move as they did."""

import numpy as np
import pytest
from numpy.testing import assert_allclose

import cutcell
from cutcell.editing import Edits, JointEdit
from cutcell.errors import SkeletonError
from tests.cutcell.io.gltf.gltf_builder import column, two_skins
from tests.cutcell.io.gltf.test_gltf_clips import animate
from tests.gltf_validator.validator import errors, reports

DEMO = ("biped.glb", "robot.glb", "octopus.glb")
REAL = ("quaternius_mech_george.glb", "khronos_Fox.glb", "quaternius_deer.glb")


def change(rig, seed=5):
    """Remove, add, hang elsewhere and move some joints by chance."""
    rng = np.random.default_rng(seed)
    skeleton, names = rig.skeleton, rig.skeleton.names
    inner = [j for j in range(len(names)) if skeleton.parents[j] >= 0]
    removed = rng.choice(inner, 2, replace=False).tolist()
    stays = [j for j in range(len(names)) if j not in removed]
    joints = {}
    elsewhere = [j for j in rng.permutation(stays).tolist() if skeleton.parents[j] >= 0][:2]
    for j in elsewhere[:1]:
        free = [k for k in stays if not skeleton.subtree[j, k] and k != skeleton.parents[j]]
        joints[names[j]] = JointEdit(parent=names[int(rng.choice(free))])
    for j in elsewhere[1:]:
        joints[names[j]] = JointEdit(parent="")
    size = np.ptp(rig.mesh.bounds, axis=0).max()
    for j in rng.choice(stays, 2, replace=False).tolist():
        place = skeleton.joints[j] + 0.02 * size * rng.standard_normal(3)
        held = joints.get(names[j], JointEdit())
        joints[names[j]] = JointEdit(parent=held.parent, position=tuple(place.tolist()))
    middle = rig.mesh.bounds.mean(axis=0)
    for k, above in enumerate((names[stays[-1]], "new 0", "")):
        place = middle + 0.1 * size * rng.standard_normal(3)
        joints[f"new {k}"] = JointEdit(added=True, parent=above, position=tuple(place.tolist()))
    return Edits(joints, removed=tuple(names[j] for j in removed))


def check_saved(path, out, edits=None, tolerance=1e-5):
    rig = cutcell.load(path)
    edits = change(rig) if edits is None else edits
    other = cutcell.edited_rig(rig, edits)
    other = other.with_weights(cutcell.bind(other, 16).weights)
    cutcell.save(out, other)
    again = cutcell.load(out)
    size = np.ptp(rig.mesh.bounds, axis=0).max()
    assert sorted(again.skeleton.names) == sorted(other.skeleton.names)
    order = [again.skeleton.names.index(name) for name in other.skeleton.names]
    above = [
        again.skeleton.names[parent] if parent >= 0 else ""
        for parent in again.skeleton.parents[order]
    ]
    assert above == [
        other.skeleton.names[parent] if parent >= 0 else "" for parent in other.skeleton.parents
    ]
    assert_allclose(again.skeleton.joints[order], other.skeleton.joints, atol=1e-6 * size)
    assert_allclose(again.weights[:, order], other.weights, atol=2e-7)
    assert_allclose(again.mesh.vertices, rig.mesh.vertices, atol=1e-6 * size)
    clips = {clip.name: clip for clip in again.clips}
    for clip in other.clips:
        when = np.linspace(0, clip.duration, 4)
        if clip.name in clips:
            result = clips[clip.name].sample(when)[:, order]
            assert_allclose(result, clip.sample(when), atol=tolerance * max(size, 1))
    before, after = (errors(report) for report in reports(path, out))
    assert not after - before
    cutcell.save(out, again)  # it is a file like any other
    assert cutcell.load(out).skeleton.names == again.skeleton.names
    return other, again


@pytest.mark.parametrize("name", DEMO)
def test_demos(demo_paths, tmp_path, name):
    check_saved(demo_paths[0].with_name(name), tmp_path / "out.glb")


@pytest.mark.parametrize("name", REAL)
def test_real_characters(rigs, tmp_path, name):
    check_saved(rigs[0].with_name(name), tmp_path / "out.glb", tolerance=2e-4)


def test_a_joint_that_only_hangs_elsewhere(demo_paths, tmp_path):
    path = demo_paths[0].with_name("robot.glb")
    names = cutcell.load(path).skeleton.names
    elsewhere = Edits({"hand.L": JointEdit(parent="head")})
    _, again = check_saved(path, tmp_path / "out.glb", elsewhere)
    above = again.skeleton.parents[again.skeleton.names.index("hand.L")]
    assert again.skeleton.names[above] == "head"
    assert sorted(again.skeleton.names) == sorted(names)


def test_nodes_keep_their_numbers_and_no_key_of_a_motion_changes(demo_paths, tmp_path):
    path = demo_paths[0].with_name("biped.glb")
    _, again = check_saved(path, tmp_path / "out.glb")
    before, after = cutcell.load(path).source.document.json, again.source.document.json
    for one, other in zip(before["nodes"], after["nodes"], strict=False):
        assert one.get("name") == other.get("name")
    assert len(after["nodes"]) > len(before["nodes"])
    kept = {str(c["target"]) for animation in after["animations"] for c in animation["channels"]}
    every = {str(c["target"]) for animation in before["animations"] for c in animation["channels"]}
    assert kept < every


def test_skins_of_several_meshes_each_get_the_joints_that_they_had(tmp_path):
    path = two_skins([0, 0, 0]).save(tmp_path / "in.glb")
    rig = cutcell.load(path)
    last = rig.skeleton.names[-1]
    place = tuple((rig.skeleton.joints[-1] + 0.1).tolist())
    added = Edits({"end": JointEdit(added=True, parent=last, position=place)})
    other, again = check_saved(path, tmp_path / "out.glb", added)
    tip, held = other.skeleton.names.index("end"), len(rig.skeleton.names) - 1
    assert again.allowed is not None
    order = [again.skeleton.names.index(name) for name in other.skeleton.names]
    np.testing.assert_array_equal(again.allowed[:, order][:, tip], rig.allowed[:, held])


def test_a_motion_of_a_removed_joint_alone_goes(tmp_path):
    builder = column()
    turned = [[0, 0, 0, 1], [0, 0, 0.7071068, 0.7071068]]
    animate(builder, (1, "rotation", [0, 1], turned, "LINEAR"))
    path = builder.save(tmp_path / "in.glb")
    rig = cutcell.load(path)
    removed = Edits(removed=(rig.skeleton.names[1],))
    _, again = check_saved(path, tmp_path / "out.glb", removed)
    assert again.clips == ()


def test_a_skin_without_bind_matrices_is_refused(tmp_path):
    builder = column()
    del builder.json["skins"][0]["inverseBindMatrices"]
    rig = cutcell.load(builder.save(tmp_path / "in.glb"))
    other = cutcell.edited_rig(rig, Edits(removed=(rig.skeleton.names[1],)))
    with pytest.raises(SkeletonError, match="has no inverse bind matrices"):
        cutcell.save(tmp_path / "out.glb", other.with_weights(cutcell.bind(other, 8).weights))
