"""The script that damages rigs prints what was found of each damage, and what was missed."""

import numpy as np
import pytest

import cutcell
from cutcell_lab.benchmarks import diagnosis
from cutcell_lab.benchmarks.damages import DAMAGES, Damaged
from tests.benchmarks.markdown import read_tables
from tests.cutcell.diagnosis.worm import worm

pytestmark = pytest.mark.nightly


def test_found_and_missed_are_told(capsys, tmp_path, monkeypatch):
    path, out = tmp_path / "worm.glb", tmp_path / "tables.md"
    cutcell.save(path, worm())
    untouched = ("rims", lambda rig, seed: Damaged(rig, np.arange(3), "vertices"))
    some = {"a hole torn": DAMAGES["a hole torn"], "nothing done": untouched}
    monkeypatch.setattr(diagnosis, "DAMAGES", some)
    diagnosis.main([str(path), "--resolution", "16", "--markdown", str(out)])
    printed = capsys.readouterr().out
    assert out.read_text() == printed
    damaged, sound = read_tables(printed).values()
    assert [row["worm"] for row in damaged] == ["note", "**missed** (0%)", ""]
    assert damaged[-1]["damage"] == "**found: 1 of 2**"
    assert (sound[0]["errors"], sound[0]["notes"]) == ("-", "0")
