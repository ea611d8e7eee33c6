"""What the README shows is true: its example runs, its commands exist, its links lead somewhere."""

import re
import shutil
from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner

import cutcell
from cutcell.cli.app import app
from cutcell_assets import demo_path

ROOT = Path(__file__).resolve().parent.parent
README = (ROOT / "README.md").read_text(encoding="utf-8")
PAGES = [ROOT / name for name in ("README.md", "CONTRIBUTING.md", "CHANGELOG.md")]
DOCUMENTS = [*PAGES, *sorted((ROOT / "docs").rglob("*.md"))]


@pytest.mark.slow
def test_the_examples_run(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    example, stages = re.findall(r"```python\n(.*?)```", README, re.DOTALL)
    names: dict = {}
    exec(example, names)
    assert "graph" in capsys.readouterr().out
    assert len(names["distances"]) == len(names["weights"])
    assert cutcell.load("bound.glb").weights is not None
    exec(stages, names)
    expected = cutcell.bind(names["rig"], method=names["method"]).weights
    np.testing.assert_allclose(names["weights"], expected, atol=1e-12)


@pytest.mark.slow
def test_the_commands_run(tmp_path, monkeypatch):
    shutil.copy(demo_path("biped"), tmp_path / "character.glb")
    monkeypatch.chdir(tmp_path)
    commands = re.findall(r"^cutcell (.*)$", README, re.MULTILINE)
    assert len(commands) == 13
    for command in commands:
        if command.startswith("app "):  # it serves until it is stopped; tests/app opens it
            continue
        assert CliRunner().invoke(app, command.split()).exit_code == 0


@pytest.mark.parametrize("page", DOCUMENTS, ids=lambda page: page.name)
def test_links_lead_somewhere(page):
    text = page.read_text(encoding="utf-8")
    links = re.findall(r"(?<!\")\]\(([^)#]+)", text) + re.findall(r'src(?:set)?="([^"]+)"', text)
    # `make docs` writes pages into docs/auto_*, and fails where one is missing.
    local = [link for link in links if not link.startswith(("http", "auto_"))]
    assert [link for link in local if not (page.parent / link).exists()] == []


def test_make_targets_that_are_spoken_of_exist():
    rules = re.findall(r"^([a-z -]+):", (ROOT / "Makefile").read_text(), re.MULTILINE)
    targets = set(" ".join(rules).split())
    spoken = {
        t for page in PAGES for t in re.findall(r"(?:^|`)make ([a-z-]+)", page.read_text(), re.M)
    }
    assert spoken <= targets
    assert {"app", "test", "lock"} <= spoken
