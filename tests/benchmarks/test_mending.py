"""Damage to weights, and the comparison of mended files with undamaged weights."""

from dataclasses import replace

import numpy as np
import pytest

import cutcell
from benchmarks import damage, mending
from benchmarks.damage import DAMAGES, Damage
from cutcell.editing.symmetry import find_mirror
from tests.app.small import small_rig

LEFT = ("upper_arm.L", "forearm.L")


@pytest.fixture
def rig():
    """Return a symmetric figure whose vertices each follow two joints or more."""
    rig = small_rig()
    away = np.linalg.norm(rig.mesh.vertices[:, None] - rig.skeleton.joints, axis=2)
    weights = np.maximum(1 - away, 0) + 1e-3 * (away < 1.2)
    return rig.with_weights(weights / weights.sum(axis=1, keepdims=True))


def joint(rig, name):
    return rig.skeleton.names.index(name)


def test_a_leak_gives_a_part_of_a_weight_away(rig):
    weights = damage.leaked(rig, "hips", "hand.L", 0.25)
    hips, hand = joint(rig, "hips"), joint(rig, "hand.L")
    np.testing.assert_allclose(weights[:, hips], 0.75 * rig.weights[:, hips])
    np.testing.assert_allclose(weights[:, hand], rig.weights[:, hand] + 0.25 * rig.weights[:, hips])
    np.testing.assert_allclose(weights.sum(axis=1), 1)


def test_rigid_vertices_follow_one_joint(rig):
    weights = damage.rigid(rig, np.array([0, 3]), "head")
    assert (weights[[0, 3], joint(rig, "head")] == 1).all()
    assert damage.damaged_vertices(rig.weights, weights).tolist() == [0, 3]


def test_noise_is_repeatable_and_gives_no_other_joint_weight(rig):
    weights = damage.noisy(rig, "forearm.L")
    np.testing.assert_array_equal(weights, damage.noisy(rig, "forearm.L"))
    np.testing.assert_array_equal(weights > 0, rig.weights > 0)
    np.testing.assert_allclose(weights.sum(axis=1), 1)
    moved = rig.weights[:, joint(rig, "forearm.L")] > 0
    several = (rig.weights > 0).sum(axis=1) > 1
    changed = damage.damaged_vertices(rig.weights, weights)
    np.testing.assert_array_equal(changed, np.flatnonzero(moved & several))


def test_mirrored_names_exchange_left_and_right(rig):
    weights = damage.mirrored_names(rig)
    for name in LEFT:
        left, right = joint(rig, name), joint(rig, name.replace(".L", ".R"))
        np.testing.assert_array_equal(weights[:, left], rig.weights[:, right])
        np.testing.assert_array_equal(weights[:, right], rig.weights[:, left])
    head = joint(rig, "head")
    assert find_mirror(rig).joint[head] == head
    np.testing.assert_array_equal(weights[:, head], rig.weights[:, head])


def test_a_shifted_chain_gives_its_weights_to_another(rig):
    others = [name.replace(".L", ".R") for name in LEFT]
    weights = damage.shifted(rig, LEFT, others)
    for name, other in zip(LEFT, others, strict=True):
        both = rig.weights[:, [joint(rig, name), joint(rig, other)]].sum(axis=1)
        assert not weights[:, joint(rig, name)].any()
        np.testing.assert_allclose(weights[:, joint(rig, other)], both)


def test_a_part_of_one_side(rig):
    count = len(rig.mesh.vertices)
    rig = replace(
        rig, parts=(cutcell.Part("coat", slice(0, 4)), cutcell.Part("body", slice(4, count)))
    )
    body = damage.part_vertices(rig, "body")
    assert body.tolist() == list(range(4, count))
    left = damage.part_vertices(rig, "body", 1)
    assert (rig.mesh.vertices[left, 0] >= 0).all()
    assert 0 < len(left) < len(body)


def test_a_comparison_counts_errors_and_other_vertices(rig, tmp_path, monkeypatch):
    original, damaged, mended = (tmp_path / f"{k}.glb" for k in ("a", "b", "c"))
    cutcell.save(original, rig)
    monkeypatch.setattr(Damage, "file", original)
    one = Damage("a.glb", lambda rig: damage.rigid(rig, np.array([5]), "hand.R"))
    rig = one.load()
    assert damage.write_damaged(one, rig, damaged).tolist() == [5]
    assert np.flatnonzero(damage.changed_bytes(rig, cutcell.load(damaged))).tolist() == [5]

    cutcell.save(mended, rig)
    result = mending.compare("eye", one, rig, np.array([5]), 7, (damaged, mended))
    assert result.is_mended
    assert result.l1[0] > 0.5
    assert result.l1[1] < 1e-6
    assert not replace(result, actions=11).is_mended
    assert not replace(result, deformation=(1.0, 0.2)).is_mended

    cutcell.save(mended, rig.with_weights(damage.rigid(rig, np.array([6]), "hand.R")))
    assert mending.compare("eye", one, rig, np.array([5]), 7, (damaged, mended)).outside == 1
    assert "eye" in mending.table_of([result]).markdown()


def test_each_damage_has_a_repair():
    assert {id(mending.damage_of(name)) for name in mending.REPAIRS} == {*map(id, DAMAGES.values())}


@pytest.mark.nightly
def test_made_up_damage_is_mended_on_the_page(capsys):
    mending.main(["--only", "twist;twist, by mask"])  # exits where it is not
    assert "legs of Auto-Rig Pro" in capsys.readouterr().out


@pytest.mark.nightly
@pytest.mark.parametrize("name", DAMAGES)
def test_real_characters_are_damaged_in_some_rows_only(name, tmp_path):
    one = DAMAGES[name]
    if one.build is None and not one.file.exists():
        pytest.skip(f"{one.file.name} is not at hand")
    rig, path, plain = one.load(), tmp_path / "damaged.glb", tmp_path / "plain.glb"
    which = damage.write_damaged(one, rig, path)
    cutcell.save(plain, rig)
    again = cutcell.load(path)
    changed = np.flatnonzero(damage.changed_bytes(cutcell.load(plain), again))
    np.testing.assert_array_equal(changed, which)
    np.testing.assert_allclose(again.weights, one.make(rig), atol=1e-6)
