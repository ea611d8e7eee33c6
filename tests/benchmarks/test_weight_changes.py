"""The table of changed weights lists each character whose weights differ."""

import numpy as np
import pytest

from cutcell_lab.benchmarks import weight_changes
from tests.benchmarks.markdown import read_tables

pytestmark = pytest.mark.nightly


def test_a_changed_character_is_listed_with_its_cause(small, capsys, tmp_path, monkeypatch):
    import cutcell

    rig = cutcell.load(small)
    monkeypatch.setattr(weight_changes, "rigs_of", lambda group: [("khronos_small", rig)])
    for folder in ("old", "new"):
        weight_changes.main(["record", str(tmp_path / folder), "rigs", "--resolution", "8"])
    path = tmp_path / "new" / "rigs" / "khronos_small.known.npz"
    with np.load(path) as stored:
        arrays = dict(stored)
    arrays["weights"] = np.roll(arrays["weights"], 1, axis=1)
    arrays["scores"] = arrays["scores"] * 2
    np.savez(path, **arrays)
    capsys.readouterr()
    weight_changes.main(["compare", str(tmp_path / "old"), str(tmp_path / "new")])
    sets = read_tables(capsys.readouterr().out)
    columns = ("joints", "version", "better : worse")
    assert [tuple(row[column] for column in columns) for row in sets["All sets"]] == [
        ("known", "old", "0 : 0"),
        ("known", "new", "0 : 1"),
        ("fresh", "old", "0 : 0"),
        ("fresh", "new", "0 : 0"),
    ] * 2
    (row,) = sets["The worst characters"]
    assert row["character"] == "khronos_small"
    (row,) = sets["rigs"]
    assert (row["character"], row["joints"]) == ("khronos_small", "known")
    assert row["differs first in"] == "bones and components"
