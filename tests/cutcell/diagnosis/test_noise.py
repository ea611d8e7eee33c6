"""Noise in weights is named where it was planted, and ranks by how much it changes."""

import numpy as np
import pytest
import trimesh

import cutcell
from cutcell import Skeleton, TriangleMesh
from cutcell.diagnosis.finding import by_severity
from cutcell.diagnosis.leaks import check_leaks
from cutcell.diagnosis.subject import Subject

LEFT, RIGHT = -0.35, 0.35


def bars(lift=0.0):
    """Return two bars along x, each other's mirror images unless one is lifted, with weights."""
    box = trimesh.creation.box([0.5, 0.2, 0.2]).subdivide_to_size(0.06)
    points = np.add(box.vertices, [0.26, 0, 0])
    points = np.vstack([points * [-1, 1, 1], np.add(points, [0, lift, 0])])
    faces = np.vstack([box.faces[:, ::-1], box.faces + len(box.vertices)])
    x = points[:, :1]
    along = np.clip(np.abs(x) / RIGHT, 0, 1)
    weights = np.hstack([1 - along, along * (x < 0), along * (x > 0)])
    skeleton = Skeleton([[0, 0, 0], [LEFT, 0, 0], [RIGHT, 0, 0]], [-1, 0, 0], ["hub", "a.L", "a.R"])
    return cutcell.Rig(TriangleMesh(points, faces), skeleton, weights=weights)


def planted(rig, center, within, strength, seed=3):
    """Return weights that are noisy around a point of the axis, and where."""
    rng, weights = np.random.default_rng(seed), rig.weights.copy()
    which = np.flatnonzero(np.abs(rig.mesh.vertices[:, 0] - center) < within)
    noise = rng.random([len(which), 3])
    rows = (1 - strength) * weights[which] + strength * noise / noise.sum(axis=1, keepdims=True)
    weights[which] = rows
    return rig.with_weights(weights), which


def findings(rig):
    subject = Subject(rig, 16)
    assert subject.measurable.any()
    return {one.code: one for one in check_leaks(subject)}


@pytest.fixture(params=[0.0, 0.3], ids=["mirrored", "one side only"])
def rig(request):
    rig = bars(request.param)
    assert (Subject(rig, 16).mirror is None) == bool(request.param)
    return rig


def test_sound_weights_have_no_noise(rig):
    assert "noisy-weights" not in findings(rig)
    steps = np.eye(3)[rig.weights.argmax(axis=1)]
    assert "noisy-weights" not in findings(rig.with_weights(steps))


def test_noise_is_named_where_it_was_planted(rig):
    noisy, which = planted(rig, -0.2, 0.08, 0.8)
    finding = findings(noisy)["noisy-weights"]
    around = np.abs(rig.mesh.vertices[:, 0] + 0.2) < 0.08 + 0.07  # and next to it
    assert around[finding.vertices].all()
    assert np.isin(finding.vertices, which).mean() > 0.7
    amount = np.abs(noisy.weights - rig.weights).sum(axis=1)
    assert amount[finding.vertices].sum() > 0.3 * amount.sum()
    assert finding.severity == "warning"


def test_few_strong_rows_rank_above_many_faint_ones(rig):
    is_mirrored = Subject(rig, 16).mirror is not None
    many, faint = planted(rig, -0.4, 0.1, 0.12 if is_mirrored else 0.4)
    one, strong = planted(rig, 0.2, 0.03, 0.97)
    both, _ = planted(many, 0.2, 0.03, 0.97)
    assert len(strong) < len(faint) / 2
    few, more = (findings(rig)["noisy-weights"] for rig in (one, many))
    assert few.change > more.change
    assert by_severity([more, few]) == (few, more) == by_severity([few, more])
    finding = findings(both)["noisy-weights"]
    assert finding.change == pytest.approx(few.change + more.change, rel=0.01)
    assert finding.details[0] == few.details[0]


def test_noise_that_is_alike_on_both_sides_is_none():
    rig = bars()
    noisy, which = planted(rig, -0.2, 0.08, 0.8)
    mirror = Subject(rig, 16).mirror
    weights = noisy.weights.copy()
    weights[mirror.vertex[which]] = weights[which][:, mirror.swap]
    assert "noisy-weights" not in findings(noisy.with_weights(weights))
