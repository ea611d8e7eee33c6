"""A repair removes what it was for, brings nothing new, and can be saved into the document."""

from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

import cutcell
from cutcell import ParameterError
from cutcell.io.gltf.container import read_document
from cutcell_assets import demo_path
from cutcell_lab.benchmarks.damages import DAMAGES, READING
from tests.cutcell.diagnosis.worm import SWEEP, worm

WORM = worm()
REPAIRABLE = [
    "a patch of faces turned",
    "faces doubled",
    "faces without area",
    "weights no numbers",
    "weights of 3/4",
    "skin without weight",
    "six influences",
    "seams that tear",
]


def from_lowest(faces):
    """Begin each face at its lowest corner; its orientation stays."""
    return np.array([np.roll(face, -face.argmin()) for face in faces])


def damaged(name, folder):
    code, damage = DAMAGES[name]
    rig = damage(WORM, 7, *([folder] if damage in READING else [])).rig
    return code, cutcell.diagnose(rig, 24)


@pytest.mark.parametrize("name", REPAIRABLE)
def test_a_repair_removes_its_finding_and_brings_no_other(name, tmp_path):
    code, before = damaged(name, tmp_path)
    repaired = before.repaired([code])
    assert [f.code for f in repaired.repaired] == [code]
    assert len(repaired.done) == 1
    after = cutcell.diagnose(repaired.rig, 24)
    assert code not in after
    # Repaired weights may bend worse than those that were no weights.
    assert {f.code for f in after.findings} <= {f.code for f in before.findings} | SWEEP
    sums = repaired.rig.weights.sum(axis=1)
    assert np.logical_or(np.abs(sums - 1) < 1e-9, sums == 0).all()


def test_an_island_is_cleaned_where_it_was_found_alone():
    weights = WORM.weights.copy()
    island = np.flatnonzero(WORM.mesh.vertices[:, 0] > 0.93)
    weights[island] = np.eye(weights.shape[1])[1]  # the head follows the tail
    before = cutcell.diagnose(WORM.with_weights(weights), 24)
    codes = [code for code in ("weight-islands", "leaked-weights") if code in before]
    assert "weight-islands" in codes
    repaired = before.repaired(codes).rig
    assert repaired.weights[island, 1].max() < 0.01
    elsewhere = np.setdiff1d(
        np.arange(len(weights)), np.concatenate([before[code].vertices for code in codes])
    )
    assert len(elsewhere)
    assert_allclose(repaired.weights[elsewhere], weights[elsewhere], atol=1e-12)
    assert "weight-islands" not in cutcell.diagnose(repaired, 24)


def test_what_is_not_safe_is_not_offered(tmp_path):
    _, before = damaged("a hole torn", tmp_path)
    assert not before["rims"].repair
    with pytest.raises(ParameterError, match='nothing to repair of the code "rims"'):
        before.repaired(["rims"])


def test_everything_that_can_be_is_repaired_at_once(tmp_path):
    _, before = damaged("weights no numbers", tmp_path)
    result = {f.code for f in before.findings}
    assert result - SWEEP == {"invalid-weights", "unweighted-vertices"}
    assert {f.code for f in cutcell.diagnose(before.repaired().rig, 24).findings} <= SWEEP


def test_skin_without_weight_gets_that_of_its_neighbours(tmp_path):
    _, before = damaged("skin without weight", tmp_path)
    rows = before["unweighted-vertices"].vertices
    filled = before.repaired().rig.weights
    assert np.abs(filled[rows] - WORM.weights[rows]).sum(axis=1).mean() < 0.6
    rest = np.delete(np.arange(len(filled)), rows)
    assert_allclose(filled[rest], WORM.weights[rest], atol=1e-12)


def test_a_repaired_document_keeps_all_else(tmp_path):
    rig = cutcell.load(demo_path("biped_flipped_arm"))
    repaired = cutcell.diagnose(rig, 24).repaired().rig
    cutcell.save(tmp_path / "fixed.glb", repaired)
    again = cutcell.load(tmp_path / "fixed.glb")
    sound = cutcell.load(demo_path("biped"))
    assert_array_equal(from_lowest(again.mesh.faces), from_lowest(sound.mesh.faces))
    assert_array_equal(again.mesh.vertices, rig.mesh.vertices)
    assert_allclose(again.weights, rig.weights, atol=1e-6)
    before, after = (
        read_document(p).json for p in (demo_path("biped_flipped_arm"), tmp_path / "fixed.glb")
    )
    for skin in after["skins"]:
        assert list(skin.pop("extras")) == ["cutcell_deform"]
    for kept in ("animations", "nodes", "materials", "skins"):
        assert after.get(kept) == before.get(kept)


def test_a_repair_in_vain_leaves_nothing_changed(monkeypatch):
    weights = WORM.weights.copy()
    island = np.flatnonzero(WORM.mesh.vertices[:, 0] > 0.93)
    weights[island] = np.eye(weights.shape[1])[1]
    before = cutcell.diagnose(WORM.with_weights(weights), 24)
    again = before.repaired(["weight-islands"])
    assert [finding.code for finding in again.repaired] == ["weight-islands"]
    assert again.in_vain == ()

    def no_better(rig, *args):
        """Let the island follow another far joint."""
        other = weights.copy()
        other[island] = np.eye(weights.shape[1])[2]
        return replace(cutcell.clean(rig), weights=other)

    monkeypatch.setattr("cutcell.diagnosis.repair.clean", no_better)
    repaired = before.repaired(["weight-islands"])
    assert repaired.rig.weights is before.rig.weights
    assert repaired.repaired == ()
    assert [finding.code for finding in repaired.in_vain] == ["weight-islands"]
