"""The failures of the documentation: each is what its page says."""

import sys
from pathlib import Path

import numpy as np
import pytest

import cutcell
from cutcell.graph.cutcell_graph import INTERIOR
from cutcell_app.headless.interactive import VIEWS

sys.path.append(str(Path(__file__).resolve().parent.parent / "docs"))

from failures import FAILURES


def made(id):
    failure = next(one for one in FAILURES if one.id == id)
    rig = failure.make()
    return rig, cutcell.bind(rig, method=cutcell.Method(**failure.method))


def test_there_are_twelve_each_with_its_cause_in_a_sentence():
    assert len({one.id for one in FAILURES}) == len(FAILURES) == 12
    for one in FAILURES:
        assert one.view in VIEWS
        for text in (one.cause, one.remedy):
            assert text.endswith(".")
            assert ". " not in text
            assert len(text.split()) <= 30


@pytest.mark.slow
@pytest.mark.parametrize("failure", FAILURES, ids=lambda one: one.id)
def test_the_check_finds_the_cause(failure):
    rig = failure.make()
    assert not failure.bone or failure.bone in rig.skeleton.names
    if failure.finding:
        codes = {one.code for one in cutcell.diagnose(rig).findings}
        assert failure.finding in codes


@pytest.mark.parametrize(
    ("id", "part"), [("inside-out-arm", "forearm.R"), ("flipped-patch", "spine")]
)
def test_a_flipped_part_has_no_interior_until_it_is_repaired(id, part):
    rig, binding = made(id)
    joint = rig.skeleton.joints[rig.skeleton.names.index(part)]
    repaired = cutcell.bind(rig).graph

    def near(graph):
        points = graph.lattice.to_file(graph.nodes[graph.node_kind == INTERIOR])
        return int((np.linalg.norm(points - joint, axis=1) < 0.05).sum())

    assert near(binding.graph) < 0.2 * near(repaired)


def test_close_fingers_stay_apart_and_crossing_limbs_do_not():
    rig, binding = made("two-bodies-close")
    names = rig.skeleton.names
    tips = [
        np.linalg.norm(rig.mesh.vertices - [x, 1.15, 0], axis=1).argmin() for x in (-0.05, 0.05)
    ]
    right, left = binding.distances.on_mesh(names.index("left_3"))[tips]
    straight = np.linalg.norm(np.diff(rig.mesh.vertices[tips], axis=0))
    assert straight < 0.15
    assert (right - left) * binding.graph.lattice.size > 1.5
    rig, binding = made("crossing-limbs")
    distance = binding.distances.on_mesh(rig.skeleton.names.index("left_arm_3"))
    hip = rig.skeleton.joints[rig.skeleton.names.index("hips")]
    near = np.linalg.norm(rig.mesh.vertices - hip, axis=1).argmin()
    assert distance[near] * binding.graph.lattice.size < 0.4


@pytest.mark.parametrize("id", ["bone-outside", "other-units"])
def test_bones_outside_get_no_weight(id):
    _, binding = made(id)
    assert (binding.weights.sum(axis=0) == 0).any()
    assert "no weight" in binding.warnings[0]
