"""Augmentation changes a sample as another artist would have: weights stay weights."""

from dataclasses import fields, replace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from cutcell_lab.networks import Sample
from cutcell_lab.networks.augmentation import (
    components,
    drawn,
    posed,
    surface_shares,
    without_joints,
)
from cutcell_lab.networks.samples import STORED_NEIGHBOURS

SEEDS = range(25)


def chain(count: int, spacing: float = 0.1) -> Sample:
    """Return points in a row, each held by the nearest of four joints in a row."""
    along = np.arange(count) * spacing
    points = np.column_stack([along, np.zeros((count, 2))]).astype(np.float32)
    joints = np.column_stack([np.linspace(0, along[-1], 4), np.zeros((4, 2))]).astype(np.float32)
    order = np.argsort(np.abs(along[:, None] - along), axis=1, kind="stable")[
        :, 1 : STORED_NEIGHBOURS + 1
    ]
    own = np.repeat(np.arange(count)[:, None], STORED_NEIGHBOURS - order.shape[1], axis=1)
    nearest = np.abs(points[:, :1] - joints[:, 0]).argmin(axis=1)
    weights = np.eye(4, dtype=np.float32)[nearest]
    return Sample(
        "chain",
        points,
        np.tile(np.float32([0, 1, 0]), (count, 1)),
        joints,
        joints[[1, 2, 3, 3]],
        np.arange(-1, 3),
        weights,
        weights,
        np.concatenate([order, own], axis=1).astype(np.int64),
        np.arange(count),
        np.arange(4),
    )


def same(one: Sample, other: Sample) -> bool:
    pairs = [(getattr(one, field.name), getattr(other, field.name)) for field in fields(one)]
    return all(np.array_equal(a, b) for a, b in pairs)


@pytest.mark.parametrize("seed", SEEDS)
def test_weights_still_sum_to_one_and_all_fits_together(biped, seed):
    sample = drawn(biped, 40, np.random.default_rng(seed), augment=True)
    count, joints = len(sample.points), len(sample.joints)
    assert 16 <= count <= 40
    for weights in (sample.target, sample.prior):
        assert weights.shape == (count, joints)
        assert weights.min() >= 0
        np.testing.assert_allclose(weights.sum(axis=1), 1, atol=1e-5)
    assert sample.neighbours.shape == (count, STORED_NEIGHBOURS)
    assert sample.neighbours.min() >= 0
    assert sample.neighbours.max() < count
    assert ((sample.parents >= -1) & (sample.parents < joints)).all()
    assert len(sample.tails) == len(sample.deform) == len(sample.parents) == joints
    np.testing.assert_allclose(np.linalg.norm(sample.normals, axis=1), 1, atol=1e-5)


@pytest.mark.parametrize("seed", SEEDS)
def test_neighbours_are_those_of_before_that_are_left(biped, seed):
    sample = drawn(biped, 40, np.random.default_rng(seed), augment=True)
    place = {vertex: k for k, vertex in enumerate(biped.vertices)}
    for k, vertex in enumerate(sample.vertices):
        before = biped.vertices[biped.neighbours[place[vertex]]]
        wanted = [v for v in before if v in sample.vertices and v != vertex]
        result = sample.vertices[sample.neighbours[k]]
        np.testing.assert_array_equal(result[: len(wanted)], wanted)
        assert (result[len(wanted) :] == vertex).all()


def test_the_same_seed_gives_the_same_sample(biped):
    one, other = (drawn(biped, 40, np.random.default_rng(3), augment=True) for _ in range(2))
    assert same(one, other)
    assert not same(one, drawn(biped, 40, np.random.default_rng(4), augment=True))


def test_each_change_happens_and_none_always(biped):
    result = [drawn(biped, 96, np.random.default_rng(seed), augment=True) for seed in SEEDS]
    lost = np.array([len(sample.points) < len(biped.points) for sample in result])
    sparse = np.array([len(sample.joints) < len(biped.joints) for sample in result])
    for what in (lost, sparse):
        assert 0 < what.sum() < len(result)


def test_without_augmentation_nothing_but_heading_size_and_points_changes(biped):
    for seed in SEEDS:
        sample = drawn(biped, 40, np.random.default_rng(seed))
        assert len(sample.points) == 40
        np.testing.assert_array_equal(sample.parents, biped.parents)
        place = {vertex: k for k, vertex in enumerate(biped.vertices)}
        rows = [place[vertex] for vertex in sample.vertices]
        np.testing.assert_array_equal(sample.target, biped.target[rows])


def test_weight_of_a_joint_left_out_goes_to_the_nearest_ancestor_kept(biped):
    left_out = np.zeros(len(biped.joints), bool)
    leaf = int(np.flatnonzero(~np.isin(np.arange(len(left_out)), biped.parents))[0])
    parent = int(biped.parents[leaf])
    left_out[[leaf, parent]] = True
    heir = int(biped.parents[parent])
    assert heir >= 0
    sample = without_joints(biped, left_out)
    kept = np.flatnonzero(~left_out)
    np.testing.assert_array_equal(sample.deform, biped.deform[kept])
    place = int(np.searchsorted(kept, heir))
    for now, before in ((sample.target, biped.target), (sample.prior, biped.prior)):
        wanted = before[:, kept].copy()
        children = np.flatnonzero(biped.parents == parent)
        assert set(children) == {leaf}
        wanted[:, place] += before[:, leaf] + before[:, parent]
        np.testing.assert_allclose(now, wanted, atol=1e-6)


def test_bones_are_made_anew_where_a_joint_is_left_out():
    sample = without_joints(chain(13), np.array([False, True, False, False]))
    np.testing.assert_array_equal(sample.parents, [-1, 0, 1])
    np.testing.assert_allclose(sample.tails[:, 0], [0.8, 1.2, 1.2], atol=1e-6)
    shorter = without_joints(chain(13), np.array([False, False, False, True]))
    np.testing.assert_allclose(shorter.tails[2], shorter.joints[2])


def test_roots_stay(biped):
    sample = without_joints(biped, np.ones(len(biped.joints), bool))
    np.testing.assert_array_equal(sample.parents, -1)
    assert len(sample.joints) == (biped.parents < 0).sum()
    np.testing.assert_allclose(sample.target.sum(axis=1), 1, atol=1e-5)


def test_leaving_out_nothing_changes_nothing(biped):
    assert same(without_joints(biped, np.zeros(len(biped.joints), bool)), biped)


def test_posing_by_the_identity_changes_nothing(biped):
    still = posed(biped, np.tile(np.eye(3), (len(biped.joints), 1, 1)))
    for name in ("points", "normals", "joints", "tails"):
        np.testing.assert_allclose(getattr(still, name), getattr(biped, name), atol=1e-6)


def test_turning_the_root_turns_all(biped):
    turns = np.tile(np.eye(3), (len(biped.joints), 1, 1))
    turns[biped.parents < 0] = turn = Rotation.from_rotvec([0.3, -0.2, 0.5]).as_matrix()
    moved = posed(biped, turns)
    root = biped.joints[biped.parents < 0][0]
    for name in ("points", "joints", "tails"):
        wanted = (getattr(biped, name) - root) @ turn.T + root
        np.testing.assert_allclose(getattr(moved, name), wanted, atol=1e-5)
    np.testing.assert_allclose(moved.normals, biped.normals @ turn.T, atol=1e-5)


def test_a_turned_joint_takes_what_it_holds_along_and_nothing_else():
    sample = chain(13)
    turns = np.tile(np.eye(3), (4, 1, 1))
    turns[2] = Rotation.from_rotvec([0, 0, np.pi / 2]).as_matrix()
    moved = posed(sample, turns)
    above = sample.target[:, :2].any(axis=1)
    np.testing.assert_allclose(moved.points[above], sample.points[above], atol=1e-6)
    np.testing.assert_allclose(moved.points[~above, 0], 0.8, atol=1e-5)
    np.testing.assert_allclose(moved.normals[~above], [[-1, 0, 0]] * (~above).sum(), atol=1e-5)
    np.testing.assert_allclose(moved.tails[2], moved.joints[3], atol=1e-5)


def test_what_no_joint_holds_stays_where_it_is(biped, rng):
    loose = replace(biped, target=biped.target * (np.arange(len(biped.points)) > 5)[:, None])
    turns = Rotation.from_rotvec(rng.normal(size=(len(biped.joints), 3))).as_matrix()
    moved = posed(loose, turns)
    np.testing.assert_array_equal(moved.points[:6], biped.points[:6])
    np.testing.assert_allclose(moved.normals[:6], biped.normals[:6], atol=1e-6)


def test_components_are_told_and_a_small_one_can_be_dropped():
    one = chain(40)
    far = replace(one, neighbours=np.where(one.neighbours < 30, one.neighbours, 0))
    far.neighbours[:30] = np.where(one.neighbours[:30] < 30, one.neighbours[:30], 0)
    far.neighbours[30:] = np.where(
        one.neighbours[30:] >= 30, one.neighbours[30:], np.arange(30, 40)[:, None]
    )
    label = components(far)
    assert len(set(label[:30])) == len(set(label[30:])) == 1
    assert label[0] != label[30]
    counts = {len(drawn(far, 40, np.random.default_rng(s), augment=True).points) for s in SEEDS}
    assert counts == {30, 40}


def test_points_are_spread_by_area_or_by_vertex():
    sample = chain(60, 0.01)
    sparse = replace(sample, points=sample.points.copy())
    sparse.points[30:, 0] += np.arange(30) * 0.09
    shares = surface_shares(sparse)
    np.testing.assert_allclose(shares[45:].mean() / shares[:24].mean(), 100, rtol=0.2)
