"""Weights that cannot be true are taken away; all others stay, to the last bit."""

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import cutcell
from cutcell import Rig, TriangleMesh
from cutcell.diagnosis.cleaning import connected_weights
from cutcell.errors import SkeletonError, WeightsError
from cutcell_assets import demo_path
from cutcell_lab.metrics import vertex_shares, weight_l1
from tests.cutcell.diagnosis.worm import worm

WORM = worm()
BIPED = cutcell.load(demo_path("biped"))


def slow_connected(weights, anchored, edges):
    """Connect one joint by lowering a threshold over its values: flood fill above each."""
    result = np.where(anchored, weights, 0.0)
    for level in np.unique(weights[weights > 0]):
        above = weights >= level
        seen = {v for v in np.flatnonzero(anchored & above).tolist()}
        grown = True
        while grown:
            more = {int(b) for a, b in [*edges, *edges[:, ::-1]] if a in seen and above[b]} - seen
            seen, grown = seen | more, bool(more)
        for v in seen:
            result[v] = max(result[v], level)
    return result


@settings(max_examples=60)
@given(st.integers(0, 10**6))
def test_connected_weights_are_those_of_flood_fills(seed):
    rng = np.random.default_rng(seed)
    count = int(rng.integers(2, 12))
    edges = rng.integers(0, count, (int(rng.integers(0, 20)), 2)).astype(np.int32)
    weights = rng.integers(0, 6, (count, 3)) / 5
    anchored = rng.random((count, 3)) < 0.25
    result = connected_weights(weights, anchored, edges)
    for j in range(3):
        assert np.array_equal(result[:, j], slow_connected(weights[:, j], anchored[:, j], edges))


def test_of_an_island_no_more_is_left_than_in_the_valley_around_it():
    weights = np.array([1.0, 0.6, 0.1, 0.4, 0.9])[:, None]
    anchored = np.arange(5)[:, None] == 0
    edges = np.array(list(pairwise(range(5))), np.int32)
    assert connected_weights(weights, anchored, edges)[:, 0].tolist() == [1.0, 0.6, 0.1, 0.1, 0.1]


@pytest.mark.parametrize("rig", [WORM, BIPED], ids=lambda rig: rig.name)
def test_sound_weights_hardly_change(rig):
    cleaned = cutcell.clean(rig, 32)
    assert weight_l1(cleaned.weights, rig.weights) < 0.001
    untouched = np.setdiff1d(np.arange(len(rig.weights)), cleaned.vertices)
    assert np.array_equal(cleaned.weights[untouched], rig.weights[untouched])
    assert len(untouched) > 0.9 * len(rig.weights)
    assert not len(cleaned.bound)


def test_an_island_is_bound_again_and_told():
    weights = WORM.weights.copy()
    island = np.flatnonzero(WORM.mesh.vertices[:, 0] > 0.93)
    weights[island] = np.eye(7)[1]  # the head follows the tail
    damaged = WORM.with_weights(weights)
    cleaned = cutcell.clean(damaged, 24)
    assert np.array_equal(cleaned.bound, island)
    assert cleaned.weights[island, 1].max() == 0
    assert weight_l1(cleaned.weights, WORM.weights) < 0.2 * weight_l1(weights, WORM.weights)
    (loss,) = cleaned.losses
    assert (loss.joint, loss.name, loss.largest) == (1, "tail", 1.0)
    assert np.array_equal(loss.vertices, island)
    assert 0 < cleaned.share < loss.share < 1


def test_a_leak_is_taken_away_and_the_rest_keeps_its_proportions():
    hand, thigh = (BIPED.skeleton.names.index(name) for name in ("hand.L", "thigh.L"))
    hip = np.flatnonzero(BIPED.weights[:, thigh] > 0.9)
    weights = BIPED.weights.copy()
    weights[hip] *= 0.7
    weights[hip, hand] += 0.3
    cleaned = cutcell.clean(BIPED.with_weights(weights), 32)
    np.testing.assert_allclose(cleaned.weights[hip], BIPED.weights[hip], atol=0.01)
    (loss,) = [loss for loss in cleaned.losses if loss.largest > 0.05]
    assert loss.joint == hand
    assert loss.largest == pytest.approx(0.3)
    assert np.isin(hip, loss.vertices).all()
    assert not len(cleaned.bound)


def test_noise_of_far_joints_goes():
    rng = np.random.default_rng(3)
    weights = BIPED.weights.copy()
    noisy = np.flatnonzero(rng.random(len(weights)) < 0.1)
    weights[noisy] *= 0.7
    weights[noisy, rng.integers(0, weights.shape[1], len(noisy))] += 0.3
    cleaned = cutcell.clean(BIPED.with_weights(weights), 32).weights
    np.testing.assert_allclose(cleaned.sum(axis=1), 1)
    assert weight_l1(cleaned, BIPED.weights) < 0.3 * weight_l1(weights, BIPED.weights)


def test_what_was_attached_as_a_whole_stays():
    """A ball that floats over the tail and follows the head is an accessory."""
    ball = worm().mesh
    vertices = 0.1 * ball.vertices + [0.1, 0.3, 0]
    count = len(WORM.mesh.vertices)
    mesh = TriangleMesh(
        np.concatenate([WORM.mesh.vertices, vertices]),
        np.concatenate([WORM.mesh.faces, ball.faces + count]),
    )
    weights = np.concatenate([WORM.weights, np.tile(np.eye(7)[6], (len(vertices), 1))])
    rig = Rig(mesh, WORM.skeleton, weights=weights)
    assert np.array_equal(cutcell.clean(rig, 24).weights[count:], weights[count:])


def test_torn_seams_stay_as_they_are():
    twice = np.concatenate([WORM.mesh.vertices, WORM.mesh.vertices])
    mesh = TriangleMesh(twice, WORM.mesh.faces)
    weights = np.concatenate([WORM.weights, np.roll(WORM.weights, 1, axis=1)])
    cleaned = cutcell.clean(Rig(mesh, WORM.skeleton, weights=weights), 24).weights
    assert np.array_equal(cleaned[: len(WORM.weights)], WORM.weights)


def test_it_keeps_what_the_file_can_store():
    allowed = np.ones(WORM.weights.shape, bool)
    island = np.flatnonzero(WORM.mesh.vertices[:, 0] > 0.93)
    allowed[np.ix_(island, [5])] = False
    weights = np.where(allowed, WORM.weights, 0)
    weights[island] = np.eye(7)[1]
    cleaned = cutcell.clean(replace(WORM, weights=weights, allowed=allowed), 24).weights
    assert not cleaned[~allowed].any()
    assert cleaned[island, 6].min() > 0.9


def test_a_rig_without_weights_or_joints_is_refused():
    with pytest.raises(WeightsError, match="no weights that could be cleaned"):
        cutcell.clean(replace(WORM, weights=None))
    with pytest.raises(SkeletonError):
        cutcell.clean(Rig(WORM.mesh, cutcell.Skeleton(np.empty((0, 3)), [], [])))


def test_artists_weights_hardly_change(rigs):
    for path in rigs:
        rig = cutcell.load(path)
        if len(rig.mesh.vertices) < 6000:
            shares = vertex_shares(rig.mesh)
            assert weight_l1(cutcell.clean(rig).weights, rig.weights, shares) < 0.01, path.stem
