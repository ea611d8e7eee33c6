"""Every script runs, in a tiny configuration, and prints tables that can be read."""

import sys
from pathlib import Path

import numpy as np
import pytest

import cutcell
from benchmarks import growth, large, memory, meshers, report, speed, start_up, timing
from cutcell.weights.warm_up import warm_up
from cutcell_lab.benchmarks import (
    accuracy,
    dataset,
    drop_in,
    half_precision,
    orientation,
    tables,
    wild,
)
from cutcell_lab.benchmarks.rigs import ROOT, load_characters
from tests.benchmarks.markdown import read_tables

DEMO = str(ROOT / "assets" / "robot.glb")
TINY = ["--resolutions", "8", "--repeats", "1", "--mesher-limit", "1"]

# Open3D and its companions warn while they are loaded.
pytestmark = [pytest.mark.nightly, pytest.mark.filterwarnings("ignore::DeprecationWarning")]


@pytest.mark.parametrize("name", [name for name in speed.TABLES if name not in ("bind", "start")])
def test_speed(name, small, capsys, tmp_path):
    out = tmp_path / "speed.md"
    speed.main([small, *TINY, "--tables", name, "--markdown", str(out)])
    printed = capsys.readouterr().out
    assert out.read_text() == printed
    (rows,) = read_tables(printed).values()
    assert "bar" in rows[0]["rig"]


def test_speed_of_binding(small, capsys):
    speed.main([small, *TINY, "--tables", "bind"])
    (rows,) = read_tables(capsys.readouterr().out).values()
    assert [row["rig"][:3] for row in rows] == ["bar", "**m"]
    assert rows[0]["Blender bone heat, elsewhere"] == "-"
    assert rows[0]["cutcell vs recipe"].endswith("x")


def test_start_up(small, capsys, monkeypatch):
    monkeypatch.setattr("benchmarks.start_up.BIND", "import cutcell.rig.rig")
    speed.main([small, *TINY, "--tables", "start", "--cold"])
    (rows,) = read_tables(capsys.readouterr().out).values()
    assert len(rows) == 4


def test_the_first_compile_finds_nothing_compiled(monkeypatch):
    says = "from cutcell.weights.warm_up import is_compiled; assert is_compiled() is {}"
    warm_up()
    start_up.run(says.format(True))
    monkeypatch.setattr("benchmarks.start_up.BIND", says.format(False))
    assert start_up.first_compile() > 0


@pytest.mark.filterwarnings("ignore::ResourceWarning")
@pytest.mark.filterwarnings("ignore::pytest.PytestUnraisableExceptionWarning")
def test_data_sets(capsys):
    dataset.main(["growth", "--assets", "50"])
    (rows,) = read_tables(capsys.readouterr().out).values()
    assert rows[0]["pairs"] == "1,225"


def test_accuracy(capsys, tmp_path):
    out = tmp_path / "accuracy.md"
    given = ["--resolutions", "6", "8", "--shapes", "ball", "box", "L-bar"]
    accuracy.main([*given, "--markdown", str(out)])
    result = read_tables(capsys.readouterr().out)
    assert result == read_tables(out.read_text())
    rows = result["Accuracy of distances"]
    assert [row["connectivity"] for row in rows[:2]] == ["6", "26"]
    assert {"ball", "box", "L-bar", "**all**"} == {row["shape"] for row in rows}


def test_prior_beside_voxels(small, capsys, monkeypatch):
    monkeypatch.setattr(drop_in, "SETS", ["bars"])
    monkeypatch.setattr(drop_in, "files_of", lambda group: [Path(small)])
    drop_in.main(["--resolution", "16", "--voxels", "16"])
    result = read_tables(capsys.readouterr().out)
    assert len(result) == 4
    (errors,) = (rows for title, rows in result.items() if title.startswith("L1"))
    assert len(errors) == 9
    assert all(0 <= float(row["voxels"]) <= 2 for row in errors)


def test_positions_of_16_bits(small, capsys, monkeypatch):
    monkeypatch.setattr(half_precision, "characters", lambda group: [("bar", cutcell.load(small))])
    half_precision.main(["rigs", "--resolution", "16"])
    result = read_tables(capsys.readouterr().out)
    assert [row["positions"] for row in result["Both beside the artists"]] == ["own", "rounded"]


def test_memory(small, capsys, tmp_path):
    out = tmp_path / "memory.md"
    memory.main([small, "--resolution", "8", "--connectivity", "6", "--markdown", str(out)])
    (rows,) = read_tables(capsys.readouterr().out).values()
    assert [row["rig"] for row in rows] == ["bar", "**most**"]
    assert read_tables(out.read_text())["Peak memory"] == rows


def test_a_connectivity_that_is_not_there_is_said(capsys, monkeypatch):
    monkeypatch.setattr(accuracy, "CONNECTIVITIES", (6, 7))
    accuracy.main(["--resolutions", "6", "--shapes", "box"])
    assert "Connectivity 7 is not there yet" in capsys.readouterr().out


def test_convergence_order():
    assert accuracy.order([10, 20, 40], [0.4, 0.2, 0.1]) == "1.00"
    assert accuracy.order([10, 20, 40], [0.4, 0.2, 1e-9]) == "exact"
    assert accuracy.order([10], [0.4]) == "-"


def test_orientation(capsys):
    broken = ROOT / "assets" / "biped_flipped_arm.glb"
    orientation.main([DEMO, str(broken), "--resolution", "8"])
    (rows,) = read_tables(capsys.readouterr().out).values()
    assert rows[0]["mesh"] == "biped_flipped_arm"
    assert int(rows[0]["turned"]) > 1000
    assert rows[-1]["mesh"] == "**nothing turned, all the same: 1**"


def test_growth(small, capsys, tmp_path):
    out = tmp_path / "growth.md"
    sizes = ["--resolutions", "8", "16", "--faces", "80", "--bones", "2"]
    growth.main([*sizes, "--rig", small, "--markdown", str(out)])
    result = read_tables(capsys.readouterr().out)
    assert len(result) == 3
    rows = result["Growth with the resolution"]
    assert [row["resolution"] for row in rows] == ["8", "16", "**slope**"]
    assert all(row["peak memory"].endswith(" MB") for row in rows[:-1])
    assert result["Growth with the faces"][0]["faces"] == "80"
    assert result["Growth with the bones"][0]["bones"] == "2"


def test_growth_says_what_failed(capsys):
    options = growth.arguments(["--rig", "nowhere.glb", "--limit", "60"])
    case = {"rig": "nowhere.glb", "connectivity": 6, "resolution": 8}
    assert "nowhere.glb" in growth.run(case, options)
    options.limit = 0.01
    assert growth.run(case, options) == "over 0.01 s"


def test_large_meshes(small, capsys):
    large.main(["--rig", small, "--times", "0", "1"])
    (rows,) = read_tables(capsys.readouterr().out).values()
    assert [row["faces"] for row in rows] == ["112", "448", "**slope**"]
    assert rows[0]["peak memory of bind"].endswith(" MB")


def test_slopes():
    sizes = [1, 2, 4, 8, 16]
    assert growth.slope(sizes, [7, 3, 16, 64, 256]) == pytest.approx(2)
    assert np.isnan(growth.slope([1], [1]))


def test_report(small, tmp_path):
    out = tmp_path / "performance.md"
    report.main(["--quick", "--rigs", small, "--parts", "accuracy", "--out", str(out)])
    text = out.read_text()
    assert "## Accuracy" in text
    assert "cores" in text
    assert read_tables(text)["Accuracy of distances"]


@pytest.mark.parametrize(
    ("code", "expected"),
    [
        ('print(\'{"missing": "x"}\')', "not installed"),
        ("print('chatter'); print('{\"seconds\": 1.5, \"cells\": 7000}')", "1.5 s (7,000 tets)"),
        ("import os, signal; os.kill(os.getpid(), signal.SIGSEGV)", "crashed (signal 11)"),
        ("raise SystemExit(3)", "failed"),
        ("while True: pass", "over 1 s"),
    ],
)
def test_whatever_meshers_do_is_put_into_words(code, expected, tmp_path, monkeypatch):
    script = tmp_path / "mesher.py"
    script.write_text(code)
    monkeypatch.setattr(meshers, "SCRIPT", script)
    options = speed.arguments([DEMO, "--mesher-limit", "1", "--mesher-python", sys.executable])
    if expected != "over 1 s":
        options.mesher_limit = 60
    (character,) = load_characters([DEMO])
    assert meshers.run_mesher("any", character, options) == expected


def test_times_are_taken_in_turn():
    order = []
    ways = {name: lambda n=name: order.append(n) for name in "AB"}
    times = timing.in_turn(ways, repeats=2)
    assert order == ["A", "B"] * 3
    assert [len(times[name].seconds) for name in "AB"] == [2, 2]
    timing.in_turn(ways, repeats=5, patience=0)
    assert order == ["A", "B"] * 4


def test_a_row_must_fit_its_table():
    with pytest.raises(ValueError, match="2 cells for 1 columns"):
        tables.Table("T", ["a"]).add(1, 2)


def test_numbers_are_short():
    assert [tables.seconds(x) for x in (2e-5, 0.0123, 4.5)] == ["20 us", "12.3 ms", "4.5 s"]
    assert [tables.ratio(x) for x in (3.14, 31.4)] == ["3.1x", "31x"]


def test_wild(capsys, tmp_path, monkeypatch):
    folder = tmp_path / "data" / "rigs"
    folder.mkdir(parents=True)
    (folder / "robot.glb").write_bytes((ROOT / "assets" / "robot.glb").read_bytes())
    monkeypatch.setattr(wild, "SHARED", tmp_path / "data")
    document = tmp_path / "quality.md"
    document.write_text("<!-- wild -->\n<!-- /wild -->\n")
    wild.main(["--resolution", "8", "--out", str(document)])
    overall, each = read_tables(document.read_text()).values()
    assert [row["joints"] for row in overall] == ["known", "fresh"]
    assert each[0]["character"] == "robot"
    assert 0 < float(each[0]["known L1"]) < 2
    with pytest.raises(SystemExit):
        wild.main(["train"])
    assert "no characters in" in capsys.readouterr().err
