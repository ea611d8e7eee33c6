"""Parts that rigidly follow a joint far from them."""

from dataclasses import replace

import numpy as np
import pytest

import cutcell
from cutcell import Rig, Skeleton, TriangleMesh
from cutcell.diagnosis.parts import check_far_parts
from cutcell.diagnosis.subject import Subject
from tests.bars import grid_box
from tests.cutcell.diagnosis.worm import worm


def with_part(at, joint, shares=1.0, bone=None):
    """Return the worm with a small box near a place along it, and its weight on one joint."""
    rig = worm()
    corners, faces = grid_box(4)
    box = (corners - corners.mean(axis=0)) * 0.08 + at
    count = len(rig.mesh.vertices)
    mesh = TriangleMesh(
        np.vstack([rig.mesh.vertices, box]), np.vstack([rig.mesh.faces, faces + count])
    )
    weights = np.zeros((len(box), 7))
    weights[:, joint] = shares
    weights[:, joint - 1] += 1 - shares
    weights = np.vstack([rig.weights, weights])
    skeleton = rig.skeleton
    if bone is not None:
        names = (*skeleton.names, "blade", "blade tip")
        joints = np.vstack([skeleton.joints, bone])
        skeleton = Skeleton(joints, [*skeleton.parents, 6, 7], names)
        weights = np.hstack([weights, np.zeros((len(weights), 2))])
    return Rig(mesh, skeleton, weights), np.arange(count, count + len(box))


@pytest.mark.parametrize("joint", [1, 2])
def test_a_part_that_follows_a_far_joint_is_named_with_the_nearest(joint):
    rig, part = with_part([0.9, 0.15, 0.0], joint)
    finding = cutcell.diagnose(rig, 24, only_weights=True)["far-parts"]
    assert finding.vertices.tolist() == part.tolist()
    assert finding.joints.tolist() == [joint]
    ((vertex, nearest),) = finding.parts
    assert vertex in part
    assert nearest in (5, 6)
    assert finding.details[0].startswith(f"Part 2 ({len(part)} vertices)")
    assert finding.to_dict()["parts"] == [[vertex, nearest]]
    glued = cutcell.Filled({rig.skeleton.names[nearest]: 1})
    layer = cutcell.Layer(glued, cutcell.Mask(part=vertex))
    bound = cutcell.bind(rig, 24, edits=cutcell.Edits(layers=[layer]))
    after = cutcell.diagnose(rig.with_weights(bound.weights), 24, only_weights=True)
    assert "far-parts" not in after


def test_a_bone_of_the_part_is_the_nearest():
    at = np.array([0.5, 0.2, 0.0])
    rig, _ = with_part(at, 1, bone=[at, np.add(at, [0.05, 0, 0])])
    ((_, nearest),) = cutcell.diagnose(rig, 24, only_weights=True)["far-parts"].parts
    assert rig.skeleton.names[nearest] == "blade"


@pytest.mark.parametrize(
    ("at", "joint", "shares"),
    [
        ([0.9, 0.15, 0.0], 6, 1.0),  # the nearest
        ([0.9, 0.15, 0.0], 5, 1.0),  # its neighbour
        ([0.9, 0.15, 0.0], 2, 0.6),  # not rigid
    ],
)
def test_other_parts_are_no_fault(at, joint, shares):
    rig, _ = with_part(at, joint, shares)
    assert "far-parts" not in cutcell.diagnose(rig, 24, only_weights=True)


def test_an_empty_joint_in_a_part_is_named_but_no_control():
    at = np.array([0.5, 0.2, 0.0])
    rig, _ = with_part(at, 1, bone=[at, np.add(at, [0.5, 0, 0])])
    names, deform = list(rig.skeleton.names), np.ones(len(rig.skeleton.names), bool)
    deform[-2:] = False
    for name, expected in (("prop", names.index("blade")), ("ik_ctrl", -1), ("handIK", -1)):
        names[-2] = name
        skeleton = replace(rig.skeleton, names=names, deform=deform)
        finding = cutcell.diagnose(replace(rig, skeleton=skeleton), 24, only_weights=True)
        assert finding["far-parts"].empty == (expected,)


def test_a_part_that_may_not_follow_the_nearest_is_no_fault():
    rig, part = with_part([0.9, 0.15, 0.0], 1)
    allowed = np.ones(rig.weights.shape, bool)
    allowed[part] = rig.weights[part] > 0
    rig = replace(rig, allowed=allowed)
    assert "far-parts" not in cutcell.diagnose(rig, 24, only_weights=True)


def test_a_part_that_moves_with_the_body_it_touches_is_no_fault():
    rig, _ = with_part([0.9, 0.15, 0.0], 1)
    weights = np.zeros_like(rig.weights)
    weights[:, 1] = 1  # the whole body follows a joint at its other end
    assert "far-parts" not in cutcell.diagnose(rig.with_weights(weights), 24, only_weights=True)


def test_two_parts_that_touch_each_other_may_both_be_wrong():
    rig, part = with_part([0.9, 0.15, 0.0], 1)
    count = len(rig.mesh.vertices)
    faces = rig.mesh.faces[(rig.mesh.faces >= part[0]).all(axis=1)]
    above = rig.mesh.vertices[part] + [0.0, 0.09, 0.0]
    mesh = TriangleMesh(
        np.vstack([rig.mesh.vertices, above]),
        np.vstack([rig.mesh.faces, faces - part[0] + count]),
    )
    both = Rig(mesh, rig.skeleton, np.vstack([rig.weights, rig.weights[part]]))
    finding = cutcell.diagnose(both, 24, only_weights=True)["far-parts"]
    assert len(finding.parts) == 2


def test_undamaged_characters_have_no_part_on_a_wrong_joint(rigs):
    for path in rigs:
        subject = Subject(cutcell.load(path), 32)
        assert not list(check_far_parts(subject)), path.name
