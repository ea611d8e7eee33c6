"""The GitHub action: what its script reports of files, and that its steps call what exists."""

import re

import pytest
import yaml

from scripts import check_rigs
from tests.conftest import ROOT
from tests.cutcell.io.gltf.gltf_builder import FACES, column

ACTION = yaml.safe_load((ROOT / "action.yml").read_text(encoding="utf-8"))


@pytest.fixture
def folder(tmp_path, monkeypatch):
    """Stand in a folder with a warning, and a file that is none, under a name to escape."""
    (tmp_path / "rigs").mkdir()
    faces = FACES.copy()
    faces[:6] = faces[:6, ::-1]
    column(faces=faces).save(tmp_path / "rigs" / "flipped.glb")
    (tmp_path / "rigs" / "50%, broken.glb").write_bytes(b"no")
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("GITHUB_STEP_SUMMARY", str(tmp_path / "summary.md"))
    return tmp_path


@pytest.mark.slow
def test_findings_are_annotated_and_drawn(folder, capsys):
    assert check_rigs.main(["none*\n rigs/**/*.glb\n", "--resolution", "16"]) == 1
    broken, flipped = capsys.readouterr().out.splitlines()
    assert broken.startswith("::error file=rigs/50%25%2C broken.glb,title=")
    assert re.match("::warning file=rigs/flipped.glb,title=[^:]+::[^\n]+%0A", flipped)
    text = (folder / "summary.md").read_text(encoding="utf-8")
    assert "2 checked" in text
    assert "| rigs/flipped.glb | warning |" in text
    page = (folder / "findings" / "index.html").read_text(encoding="utf-8")
    (picture,) = re.findall('src="([^"]+)"', page)
    assert (folder / "findings" / picture).read_bytes().startswith(b"\x89PNG")


@pytest.mark.slow
def test_only_findings_as_severe_as_asked_for_fail(folder):
    words = ["rigs/flipped.glb", "--resolution", "16", "--no-pictures", "--fail-on"]
    assert check_rigs.main([*words, "error"]) == 0
    assert check_rigs.main([*words, "warning"]) == 1
    assert not list((folder / "findings").glob("*.png"))


def test_no_file_is_an_error(folder, capsys):
    assert check_rigs.main(["*.fbx"]) == 2
    assert capsys.readouterr().out.startswith("::error ")


def test_the_action_calls_what_exists():
    steps = ACTION["runs"]["steps"]
    commands = "\n".join(step.get("run", "") for step in steps)
    scripts = re.findall(r"\$GITHUB_ACTION_PATH/([\w/.]+)", commands)
    assert scripts == ["scripts/check_rigs.py"]
    assert (ROOT / scripts[0]).is_file()
    used = set(re.findall(r"inputs\.([\w-]+)", (ROOT / "action.yml").read_text()))
    assert used == set(ACTION["inputs"])
    assert "${{" not in commands, "inputs reach a shell as variables alone"
