"""What a person says of pairs changes what is kept, and outlasts the audit."""

import json

import numpy as np
import pytest

import cutcell
from cutcell.errors import FileError, ParameterError
from cutcell_lab.dataset.audit.audit_files import (
    VERDICTS,
    load_audit,
    read_verdicts,
    save_audit,
    save_verdicts,
)
from cutcell_lab.dataset.audit.auditing import audit
from cutcell_lab.dataset.audit.duplicates import DIFFERENT, DUPLICATE
from tests.lab.dataset.planted import planted

pytestmark = pytest.mark.slow

NAMES = ("original", "units", "order", "pose")


@pytest.fixture(scope="module")
def found(tmp_path_factory, scheduler):
    """Audit a character, two copies of it, and the same in another pose."""
    folder = tmp_path_factory.mktemp("rigs")
    for name, rig in planted().items():
        if name in NAMES:
            weights = np.zeros((len(rig.mesh.vertices), len(rig.skeleton.joints)))
            weights[:, 0] = 1
            cutcell.save(folder / f"{name}.npz", rig.with_weights(weights))
    return audit([folder], points=256, scheduler=scheduler), folder


def pair_of(found, *names):
    """Return the pair of two characters."""
    pairs = [*found.pairs, *found.posed]
    return next(p for p in pairs if {found.names[p.a], found.others[p.b]} == set(names))


def test_a_pair_that_is_called_different_is_no_duplicate(found):
    result, _ = found
    assert result.keep == ["order", "pose"]
    for names in (("units", "order"), ("original", "units")):
        result = result.overrule(pair_of(result, *names), DIFFERENT)
    assert result.keep == ["order", "pose", "units"]
    assert result.verdict(pair_of(result, "units", "order")) == DIFFERENT
    result = result.overrule(pair_of(result, "units", "order"), "")
    assert result.keep == ["order", "pose"]


def test_a_pair_that_is_called_a_duplicate_is_one(found):
    result, _ = found
    posed = pair_of(result, "pose", "original")
    result = result.overrule(posed, DUPLICATE)
    assert result.keep == ["order"]
    assert len(set(result.labels)) == 1


def test_of_two_sets_what_has_no_other_is_kept(found, scheduler):
    _, folder = found
    pair = [folder / "units.npz"], [folder / "order.npz"]
    crossed = audit(*pair, points=256, scheduler=scheduler)
    assert crossed.keep == []
    assert crossed.overrule(crossed.pairs[0], DIFFERENT).keep == ["units"]


def test_no_other_verdict_is_taken(found):
    with pytest.raises(ParameterError, match=r"verdict.*different"):
        found[0].overrule(found[0].pairs[0], "perhaps")


def test_a_saved_audit_comes_back_and_can_be_overruled(found, tmp_path):
    result, folder = found
    save_audit(result, tmp_path, [folder])
    again = load_audit(tmp_path)
    assert again.to_dict() == result.to_dict()
    assert str(again.rows()) == str(result.rows())
    overruled = again.overrule(pair_of(again, "units", "order"), DIFFERENT)
    save_verdicts(overruled, tmp_path)
    assert load_audit(tmp_path).keep == overruled.keep
    assert json.loads((tmp_path / "audit.json").read_text())["overruled"] == 1
    assert read_verdicts(tmp_path) == dict(overruled.verdicts)


def test_what_cannot_be_loaded_is_told(found, tmp_path):
    result, folder = found
    with pytest.raises(FileError, match="no such file"):
        load_audit(tmp_path)
    save_audit(result, tmp_path, [folder / "units.npz"])
    with pytest.raises(FileError, match="have changed since"):
        load_audit(tmp_path)
    (tmp_path / "audit.json").write_text("{}")
    with pytest.raises(FileError, match="does not name its inputs"):
        load_audit(tmp_path)
    (tmp_path / "audit.json").write_text("{")
    with pytest.raises(FileError, match="is no JSON"):
        load_audit(tmp_path)
    for said in ("7", '[{"a": "x", "b": "y", "verdict": "perhaps"}]', "[1]"):
        (tmp_path / VERDICTS).write_text(said)
        with pytest.raises(FileError, match="must be a list"):
            read_verdicts(tmp_path)
