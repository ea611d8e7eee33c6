"""`cutcell compare`: tables, figures, refusals."""

import json

from tests.cutcell.cli.files import refused


def test_measures_each_method_on_each_rig(run, bar, tmp_path):
    rigged = tmp_path / "rigged.glb"
    assert run("bind", bar, rigged, "-r", 8).exit_code == 0
    options = ("--methods", "cutcell_rig, euclidean", "-r", 8)
    result = run("compare", rigged, *options, "--json")
    assert result.exit_code == 0
    document = json.loads(result.stdout)
    assert document["methods"] == ["cutcell_rig", "euclidean"]
    assert document["summary"]["cutcell_rig"]["l1"]["median"] < 1e-6
    table = run("compare", rigged, *options).stdout
    assert table.startswith("rigged: 12 vertices, 2 joints with weight")
    assert "cutcell_rig  0.000" in table


def test_writes_markdown_and_a_figure(run, demo_paths, tmp_path):
    plot = tmp_path / "errors.svg"
    rig = next(path for path in demo_paths if path.stem == "rabbit")
    options = ("--methods", "artist,euclidean", "--markdown", "--plot", plot)
    table = run("compare", rig, rig, *options).stdout
    assert "| euclidean |" in table
    assert "| rabbit |" in table
    assert "<svg" in plot.read_text()
    assert "cannot be" in refused(run("compare", rig, "--plot", tmp_path / "errors.txt"))


def test_unknown_methods_and_rigs_without_weights_are_told(run, bar, tmp_path):
    assert "'bone_heat'" in refused(run("compare", bar, "--methods", "magic"))
    assert "weights" in refused(run("compare", bar, "--methods", "euclidean"))
