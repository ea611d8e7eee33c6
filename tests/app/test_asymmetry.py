"""The map of symmetry, with joints that are paired by place and by name."""

from dataclasses import replace

import numpy as np
import pytest

import cutcell
from cutcell import MeshError, SkeletonError
from cutcell.editing.symmetry import find_mirror, partners_by_name
from cutcell_app.editing.symmetry.asymmetry import asymmetry, mirror_image
from cutcell_assets import demo_path
from tests.bars import bar, grid_box

BIPED = cutcell.load(demo_path("biped"))
NAMES = BIPED.skeleton.names


def number(name):
    return NAMES.index(name)


def pair_of_arms():
    """Return a bar along x with a joint in the middle and one on each side."""
    vertices, faces = grid_box(20)
    joints = np.array([[0.5, 0.1, 0.1], [0.8, 0.1, 0.1], [0.2, 0.1, 0.1]])
    skeleton = cutcell.Skeleton(joints, [-1, 0, 0], ["root", "arm.L", "arm.R"])
    return cutcell.Rig(cutcell.TriangleMesh(vertices, faces), skeleton)


def with_skeleton(**changed):
    return replace(BIPED, skeleton=replace(BIPED.skeleton, **changed), clips=(), source=None)


@pytest.fixture(scope="module")
def image():
    return mirror_image(BIPED)


@pytest.fixture(scope="module")
def mirrored():
    return cutcell.bind(BIPED, 24).weights


def test_joints_are_paired_by_place_and_name(image):
    mirror = image.mirror
    for joint, name in enumerate(NAMES):
        other = name.replace(".L", ".x").replace(".R", ".L").replace(".x", ".R")
        assert NAMES[mirror.joint[joint]] == other
        assert mirror.how[joint] == ("place" if other == name else "name")


def test_mirrored_weights_are_dark_nowhere(image, mirrored):
    values = asymmetry(mirrored, image)
    has_image = np.isfinite(values)
    assert has_image.mean() > 0.9
    assert np.quantile(values[has_image], 0.9) < 0.1


def test_the_map_shows_where_one_side_was_changed(image, mirrored):
    weights = mirrored.copy()
    arm = np.flatnonzero(weights[:, number("forearm.L")] > 0.9)
    weights[arm] = np.eye(len(NAMES))[number("chest")]
    values = asymmetry(weights, image)
    other = np.flatnonzero(mirrored[:, number("forearm.R")] > 0.9)
    assert np.nanmedian(values[arm]) > 0.9
    assert np.nanmedian(values[other]) > 0.9
    rest = np.setdiff1d(np.arange(len(values)), np.concatenate([arm, other]))
    assert np.nanquantile(values[rest], 0.85) < 0.1


def test_exact_partners_are_compared_with_each_other():
    rig = pair_of_arms()
    weights = np.random.default_rng(0).dirichlet(np.ones(3), len(rig.mesh.vertices))
    image, mirror = mirror_image(rig), find_mirror(rig)
    assert (mirror.vertex >= 0).all()
    expected = np.abs(weights - weights[mirror.vertex][:, mirror.joint]).sum(axis=1) / 2
    np.testing.assert_allclose(asymmetry(weights, image), expected)


def test_place_wins_where_names_contradict_it():
    names = list(NAMES)
    names[number("hand.L")], names[number("forearm.L")] = "forearm.L", "hand.L"
    mirror = mirror_image(with_skeleton(names=names)).mirror
    assert mirror.joint[number("hand.L")] == number("hand.R")
    assert mirror.how[number("hand.L")] == "place"


def test_names_of_the_other_side_pair_the_same_joints(image):
    names = [name.replace(".L", ".x").replace(".R", ".L").replace(".x", ".R") for name in NAMES]
    mirror = mirror_image(with_skeleton(names=names)).mirror
    assert np.array_equal(mirror.joint, image.mirror.joint)
    assert mirror.how == image.mirror.how


def test_a_joint_that_was_moved_is_paired_by_its_name():
    joints = BIPED.skeleton.joints.copy()
    joints[number("hand.L")] += 0.1 * np.ptp(BIPED.mesh.bounds, axis=0).max()
    mirror = mirror_image(with_skeleton(joints=joints)).mirror
    assert mirror.how[number("hand.L")] == "name"
    assert mirror.joint[number("hand.L")] == number("hand.R")


def test_a_joint_without_partner_is_listed():
    names = list(NAMES)
    names[number("hand.L")] = "hook"
    joints = BIPED.skeleton.joints.copy()
    joints[number("hand.L")] += 0.1 * np.ptp(BIPED.mesh.bounds, axis=0).max()
    mirror = mirror_image(with_skeleton(names=names, joints=joints)).mirror
    assert (mirror.joint[[number("hand.L"), number("hand.R")]] == -1).all()


def test_names_that_several_joints_share_pair_nothing():
    assert partners_by_name(("hand.L", "hand.L", "hand.R", "eye.L", "eye.R")).tolist() == [
        -1, -1, -1, 4, 3,
    ]  # fmt: skip


def test_a_body_that_is_not_mirrored_has_no_map():
    with pytest.raises(SkeletonError, match="not mirrored"):
        mirror_image(bar(joints=4))
    one_sided = BIPED.mesh.vertices.copy()
    one_sided[one_sided[:, 0] > 0] *= [2.0, 1.0, 1.5]
    rig = replace(BIPED, mesh=cutcell.TriangleMesh(one_sided, BIPED.mesh.faces), source=None)
    with pytest.raises(MeshError, match="only"):
        mirror_image(rig)


def test_real_characters_have_a_map(rigs):
    for path in rigs[:4]:
        rig = cutcell.load(path)
        values = asymmetry(rig.weights, mirror_image(rig))
        finite = values[np.isfinite(values)]
        assert len(finite) > 0.5 * len(values)
        assert finite.min() >= 0
        assert finite.max() <= 1 + 1e-9
