"""The scripts behind the paper's own tables and figures, in a tiny configuration."""

import sys

import numpy as np
import pytest

import cutcell
from benchmarks import graph_construction, leaks, paper
from cutcell_lab.benchmarks import clean, crosstalk, gvb, optimisation, runtime, wild
from cutcell_lab.benchmarks.rigs import ROOT
from tests.bars import bar
from tests.benchmarks.markdown import read_tables

pytestmark = pytest.mark.nightly

DEMO = str(ROOT / "assets" / "rabbit.glb")


@pytest.fixture
def document(tmp_path):
    """Make a document with marks for every table."""
    path = tmp_path / "paper.md"
    names = ("gvb", "runtime", "optimisation", "construction", "leaks", "crosstalk", "clean")
    names += ("deformation", "unreachable")
    path.write_text("".join(f"<!-- {name} -->\n<!-- /{name} -->\n" for name in names))
    return path


def test_gvb(document, small, tmp_path, capsys):
    plot = tmp_path / "gvb.png"
    given = [small, "--resolutions", "8", "16", "--plot", str(plot), "--out", str(document)]
    gvb.main(given)
    text = capsys.readouterr().out
    assert text.strip() in document.read_text()
    tables = read_tables(text)
    rows = tables[gvb.TITLE]
    assert [row["R"] for row in rows] == ["8", "8", "16", "16"]
    assert all("**" in "".join(row[name] for name in gvb.SIDES) for row in rows)
    assert len(tables["Cost over R"]) == 2
    assert plot.stat().st_size > 10_000


def test_coarse_against_fine(small, capsys, monkeypatch):
    monkeypatch.setattr(gvb, "COARSE", 8)
    monkeypatch.setattr(gvb, "FINE", 16)
    gvb.main([small, "--resolutions", "8", "16"])
    tables = read_tables(capsys.readouterr().out)
    (rows,) = [rows for title, rows in tables.items() if title.startswith("R = 8 against")]
    assert [row["rig"] for row in rows] == ["bar", "ahead of voxel", "ahead of voxel_unirig"]
    computed, reference = (
        np.array(rows[0][head].split(" / "), float) for head in ("cutcell_any, 8", "voxel, 16")
    )
    assert rows[1]["cutcell_any, 8"] == " / ".join(str(int(less)) for less in computed < reference)
    assert rows[1]["voxel, 16"] == "of 1"


def test_runtime(document, small, tmp_path, capsys):
    plot = tmp_path / "runtime.png"
    given = [small, "--resolutions", "8", "16", "--repeats", "1", "--out", str(document)]
    runtime.main([*given, "--plot", str(plot)])
    (rows,) = read_tables(capsys.readouterr().out).values()
    assert [row["method"] for row in rows] == [*gvb.SIDES] * 2
    assert plot.stat().st_size > 10_000


def test_optimisation(document, small, capsys):
    given = [small, "--resolution", "8", "--repeats", "1", "--out", str(document)]
    optimisation.main(given)
    (rows,) = read_tables(capsys.readouterr().out).values()
    assert rows[0]["rig"].startswith("bar (")
    assert rows[0]["bbw"].endswith("x)")
    optimisation.main([*given, "--limit", "0"])
    (rows,) = read_tables(capsys.readouterr().out).values()
    assert rows[0]["bbw"] == "failed"


def test_graph_construction(document, tmp_path, capsys, monkeypatch):
    """Whatever meshers do, a cell says it."""
    script = tmp_path / "mesher.py"
    script.write_text(
        "import sys\n"
        "if sys.argv[1] == 'tetgen': sys.exit(3)\n"
        'print(\'{"seconds": 60, "cells": 7}\')\n'
    )
    monkeypatch.setattr("benchmarks.meshers.SCRIPT", script)
    given = [DEMO, "--resolutions", "8", "--repeats", "1", "--out", str(document)]
    graph_construction.main(given)
    (rows,) = read_tables(capsys.readouterr().out).values()
    assert rows[0]["tetgen"] == "failed"
    assert rows[0]["pytetwild"].startswith("60 s (")


def test_the_edge_reaches_the_mesher(tmp_path, monkeypatch):
    script = tmp_path / "mesher.py"
    script.write_text("import sys; print('{\"seconds\": ' + sys.argv[3] + ', \"cells\": 1}')")
    monkeypatch.setattr("benchmarks.meshers.SCRIPT", script)
    (character,) = graph_construction.load_characters([DEMO])
    result = graph_construction.attempt("any", character, sys.executable, 60, 0.125)
    assert result == {"seconds": 0.125, "cells": 1}
    mixed = graph_construction._cell([result, "over 1 s"], [0.0625, 1.0])
    assert mixed == "125 ms (2.0x, 1 of 2 rigs)"


def test_leaks(document, capsys):
    leaks.main(["--resolution", "32", "--out", str(document)])
    (rows,) = read_tables(capsys.readouterr().out).values()
    median = {row["at the hip, from forearm and hand"]: float(row["median"]) for row in rows}
    assert median["our distance"] > 2 * median["voxel distance"]
    assert median["cage weight"] > 4 * median["our weight"]


def test_crosstalk(document, capsys, monkeypatch):
    monkeypatch.setattr(crosstalk, "PLACES", crosstalk.PLACES[2:3])
    monkeypatch.setattr(crosstalk.crosstalk_table, "__defaults__", (crosstalk.PLACES,))
    crosstalk.main(["--methods", "cutcell,voxel", "--out", str(document)])
    (rows,) = read_tables(capsys.readouterr().out).values()
    assert rows[0]["ears on a back (rabbit)"].endswith(" / 0.000")
    assert "cutcell" in document.read_text()
    with pytest.raises(SystemExit, match="unknown: wishes"):
        crosstalk.main(["--methods", "wishes"])


@pytest.mark.parametrize("script", [gvb])
def test_without_rigs_there_is_nothing_to_do(script, tmp_path, monkeypatch):
    monkeypatch.setattr(script, "SHARED", tmp_path)
    with pytest.raises(SystemExit, match="there are no rigs"):
        script.main([])


def test_parts_of_the_paper(document, tmp_path, capsys, monkeypatch):
    """The middle joint of the bar carries no weight: turning all joints is another measure."""
    rig = bar(6)
    far = rig.mesh.vertices[:, 0] > 0.5
    weights = np.stack([~far, far], axis=1).astype(float)
    skeleton = cutcell.Skeleton(
        [[0.1, 0.1, 0.1], [0.5, 0.1, 0.1], [0.9, 0.1, 0.1]], [-1, 0, 1], deform=[True, False, True]
    )
    path = tmp_path / "bar.npz"
    columns = np.insert(weights, 1, 0.0, axis=1)
    cutcell.save(path, cutcell.Rig(rig.mesh, skeleton, weights=columns))
    monkeypatch.setattr(paper, "PAPER", document)
    paper.main(["deformation", "unreachable", "--rigs", str(path)])
    text = capsys.readouterr().out
    both, lost = read_tables(text).values()
    assert [row["method"] for row in both] == list(paper.SIDES)
    assert all(float(row["mean all"]) > float(row["mean deform"]) for row in both)
    assert both[0]["joints turned: deform, all"] == "2, 3"
    assert lost[0]["with any"] == "0"
    assert all(part.strip() in document.read_text() for part in text.split("\n\n")[:2])
    with pytest.raises(SystemExit):
        paper.main(["wishes"])


def test_clean(document, capsys, monkeypatch):
    monkeypatch.setattr(wild, "files_of", lambda group: [ROOT / "assets" / "biped.glb"])
    clean.main(["rigs", "--resolution", "24", "--near", "3", "--out", str(document)])
    text = capsys.readouterr().out
    assert text[text.index("###") :].strip() in document.read_text()
    own, kinds, near, each = read_tables(text[text.index("###") :]).values()
    assert float(own[0]["L1 worst"]) < clean.ALLOWED
    assert {row["weights"] for row in kinds} <= set(clean.KINDS)
    for row in kinds:
        assert float(row["L1 after"]) < float(row["L1 before"])
        assert float(row["cm² after"]) < float(row["cm² before"])
    assert float(near[0]["own, worst L1"]) == float(own[0]["L1 worst"])
    assert [row["character"] for row in each] == ["biped"]
    with pytest.raises(SystemExit):
        clean.main(["wishes"])
