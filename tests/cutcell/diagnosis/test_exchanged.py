"""Joints with each other's weights are named, and the exchange that is offered mends them."""

import re
from dataclasses import replace

import numpy as np
import pytest
import trimesh

import cutcell
from cutcell import Edits, Layer, Mask, Remapped
from cutcell.diagnosis.exchanged import check_exchanged
from cutcell.diagnosis.subject import Subject
from cutcell.editing.symmetry import partners_by_name
from cutcell_assets import demo_path
from tests.cutcell.diagnosis.worm import worm

BIPED = cutcell.load(demo_path("biped"))
NAMES = BIPED.skeleton.names
PARTNER = partners_by_name(NAMES)
SWAP = np.where(PARTNER < 0, np.arange(len(NAMES)), PARTNER)


@pytest.fixture(scope="module")
def distances():
    return Subject(BIPED, 24).distances


def findings(rig, distances=None):
    return list(check_exchanged(Subject(rig, 24, distances)))


def mended(rig, finding):
    names = rig.skeleton.names
    content = Remapped({names[one]: names[other] for one, other in finding.exchanged})
    layer = Layer(content, Mask(vertices=finding.vertices))
    return cutcell.bind(rig, 24, edits=Edits(base="file", layers=[layer])).weights


def test_sound_characters_have_none(distances):
    assert findings(BIPED, distances) == []
    assert findings(worm()) == []


@pytest.mark.parametrize("cycle", [(2, 5), (1, 4, 6)])
def test_joints_that_were_exchanged_are_named_and_mended(cycle):
    order = np.arange(7)
    order[list(cycle)] = np.roll(cycle, 1)
    rig = worm().with_weights(worm().weights[:, order])
    (finding,) = findings(rig)
    assert finding.code == "exchanged-joints"
    assert finding.joints.tolist() == sorted(cycle)
    np.testing.assert_array_equal(mended(rig, finding), worm().weights)


@pytest.mark.parametrize("sides", [(1,), (-1,), (1, -1)])
def test_a_side_that_follows_the_other_is_named_and_mended(sides, distances):
    x = BIPED.mesh.vertices[:, 0]
    wrong = np.isin(np.sign(x), sides)
    weights = BIPED.weights.copy()
    weights[wrong] = weights[wrong][:, SWAP]
    rig = BIPED.with_weights(weights)
    found = findings(rig, distances)
    assert [one.code for one in found] == ["other-side"]
    after = mended(rig, found[0])
    error, before = (np.abs(one - BIPED.weights).sum(axis=1) for one in (after, weights))
    assert error.sum() < 0.05 * before.sum()
    now, then = map(float, re.findall(r"from ([\d.]+)% to ([\d.]+)%", found[0].message)[0])
    assert then < now / 2


def fingers():
    """Return two fingers that begin beside each other and part further on."""
    box = trimesh.creation.box([1, 0.1, 0.1]).subdivide_to_size(0.06)
    points, faces, joints, weights = [], [], [[-0.2, 0, 0]], []
    for side, length in ((1, 1.0), (-1, 0.8)):  # they are no mirror images
        along = box.vertices[:, 0] + 0.5
        bend = side * (0.04 + 1.2 * np.maximum(along - 0.4, 0))
        center = np.stack([length * along, bend, 0 * along], axis=1)
        points.append(center + box.vertices * [0, 1, 1])
        faces.append(np.array(box.faces) + len(along) * len(faces))
        at = np.array([0.02, 0.4, 0.7])
        joints += [[length * x, side * (0.04 + 1.2 * max(x - 0.4, 0)), 0] for x in at]
        weights.append(np.eye(3)[(along[:, None] > at).sum(axis=1).clip(1, 3) - 1])
    rows = np.zeros((2 * len(along), 7))
    rows[: len(along), 1:4], rows[len(along) :, 4:] = weights
    names = ["hand", *(f"{name}_{k}" for name in ("index", "middle") for k in (1, 2, 3))]
    skeleton = cutcell.Skeleton(joints, [-1, 0, 1, 2, 0, 4, 5], names)
    mesh = cutcell.TriangleMesh(np.vstack(points), np.vstack(faces))
    return cutcell.Rig(mesh, skeleton, weights=rows)


def test_joints_that_lie_together_are_exchanged_with_the_others_of_their_names():
    rig = fingers()
    assert findings(rig) == []
    order = [0, 4, 5, 6, 1, 2, 3]
    damaged = rig.with_weights(rig.weights[:, order])
    (finding,) = findings(damaged)
    assert finding.joints.tolist() == [1, 2, 3, 4, 5, 6]
    np.testing.assert_array_equal(mended(damaged, finding), rig.weights)
    other = replace(rig.skeleton, names=["hand", *"abcdef"])
    (finding,) = findings(replace(damaged, skeleton=other))
    assert finding.joints.tolist() == [2, 3, 5, 6]


def test_joints_without_skin_or_bones_do_not_disturb():
    few = replace(worm(), weights=np.eye(7)[np.zeros(len(worm().weights), int)])
    assert findings(few) == []
