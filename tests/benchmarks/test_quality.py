"""The script behind docs/quality.md."""

import json
import shutil

import pytest

import cutcell
from cutcell_lab.baselines import METHODS
from cutcell_lab.baselines.compare import compare
from cutcell_lab.benchmarks import document, quality
from tests.conftest import SHARED_RIGS


@pytest.mark.nightly
def test_named_rigs_are_measured_and_printed(demo_paths, tmp_path, capsys):
    path = next(p for p in demo_paths if p.stem == "biped_soup")
    out, plot = tmp_path / "out.json", tmp_path / "plot.svg"
    given = [str(path), "--methods", "artist,euclidean, blender", "--plot", str(plot)]
    quality.main([*given, "--json", str(out)])
    assert "- blender on biped_soup: there is no" in capsys.readouterr().out
    assert json.loads(out.read_text())["rigs"][0]["scores"][0]["l1"] == 0
    assert plot.stat().st_size > 0
    with pytest.raises(SystemExit, match="unknown: wishes"):
        quality.main([str(path), "--methods", "wishes"])


@pytest.mark.nightly
def test_the_document_is_written_and_taken_up_again(demo_paths, tmp_path, monkeypatch, capsys):
    """One rig and a torn file: first one method, then another; then nothing is left to do."""
    shared, docs = tmp_path / "shared", tmp_path / "docs"
    (shared / "rigs").mkdir(parents=True)
    (docs / "pictures").mkdir(parents=True)
    source = next(p for p in demo_paths if p.stem == "rabbit")
    shutil.copy(source, shared / "rigs" / "real.glb")
    (shared / "rigs" / "torn.glb").write_bytes(b"glTF")
    (docs / "quality.md").write_text("above\n<!-- tables -->\nold\n<!-- /tables -->\nbelow\n")
    monkeypatch.setattr(quality, "SHARED", shared)
    given = ["--docs", str(docs), "--resolution", "16"]
    quality.main([*given, "--methods", "euclidean"])
    assert "torn.glb is left out" in capsys.readouterr().err
    quality.main([*given, "--methods", "artist"])
    text = (docs / "quality.md").read_text()
    assert "old" not in text
    assert text.startswith("above")
    assert text.endswith("below\n")
    assert " | 0.000 |" in text
    assert (docs / "pictures" / "quality.png").stat().st_size > 0
    capsys.readouterr()
    quality.main([*given, "--methods", "artist", "--resume"])
    assert "real" not in capsys.readouterr().err.split()
    assert (docs / "quality.md").read_text() == text


def test_without_rigs_there_is_nothing_to_do(tmp_path, monkeypatch):
    monkeypatch.setattr(quality, "SHARED", tmp_path)
    with pytest.raises(SystemExit, match="there are no rigs"):
        quality.main(["--methods", "artist"])


def test_a_document_without_marks_is_refused(tmp_path):
    path = tmp_path / "page.md"
    path.write_text("<!-- a -->")
    with pytest.raises(ValueError, match=r"page\.md lacks the marks <!-- a --> and <!-- /a -->"):
        document.fill(path, {"a": "x"})


def test_limits_reach_those_that_have_one():
    methods = quality.chosen("bbw,voxel", 7.0)
    assert methods["bbw"].keywords == {"limit": 7.0}
    assert methods["voxel"] is METHODS["voxel"]


@pytest.mark.parametrize(
    ("name", "l1"), [("khronos_RiggedFigure", 0.75), ("khronos_CesiumMan", 0.3)]
)
def test_blenders_weights_are_read_by_name_or_by_order(name, l1):
    path = SHARED_RIGS / f"{name}.glb"
    folder = SHARED_RIGS.parent / "bone_heat"
    if not path.exists() or not folder.exists():
        pytest.skip(f"there is no {path}; it is not part of the project")
    rig = cutcell.load(path)
    result = compare([rig], {"blender": lambda rig: quality.blender(rig, folder)})
    assert result.rigs[0].scores[0].values["l1"] < l1
    assert result.rigs[0].scores[0].values["unweighted"] == 0
