"""What the README shows is true: its example runs, its commands exist, its links lead somewhere."""

import re
import shutil
import subprocess
import sys
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


@pytest.mark.parametrize("page", DOCUMENTS, ids=lambda page: page.name)
def test_anchors_are_headings(page):
    links = re.findall(r"\]\(([^)#:]*)#([^)]+)\)", page.read_text(encoding="utf-8"))
    for name, anchor in links:
        text = ((page.parent / name) if name else page).read_text(encoding="utf-8")
        titles = re.findall(r"^#+ (.*)$", text, re.MULTILINE)
        slugs = [re.sub(r"[^\w -]", "", title.lower()).replace(" ", "-") for title in titles]
        assert anchor in slugs, f"{page.name}: {name}#{anchor}"


def test_make_targets_that_are_spoken_of_exist():
    rules = re.findall(r"^([a-z -]+):", (ROOT / "Makefile").read_text(), re.MULTILINE)
    targets = set(" ".join(rules).split())
    spoken = {
        t for page in PAGES for t in re.findall(r"(?:^|`)make ([a-z-]+)", page.read_text(), re.M)
    }
    assert spoken <= targets
    assert {"app", "test", "lock"} <= spoken


PUBLIC = re.compile(r"github\.com/cutcell|cutcell\.github\.io|pypi\.org/project/cutcell")
"""Addresses that would belong to whoever registers them: see [tool.cutcell] in pyproject.toml."""
BY_NAME = re.compile(r"""pip install ["']?cutcell\b""")
"""Works only where cutcell is installed: no index has it."""


def test_no_address_of_somebody_else_is_written():
    files = subprocess.run(
        ["git", "ls-files"], cwd=ROOT, check=True, capture_output=True, text=True
    )
    texts = {
        name: (ROOT / name).read_text(encoding="utf-8", errors="ignore")
        for name in files.stdout.splitlines()
        if name != f"tests/{Path(__file__).name}" and (ROOT / name).is_file()
    }
    assert len(texts) > 1000
    assert [name for name, text in texts.items() if PUBLIC.search(text)] == []
    documents = [name for name in texts if not name.endswith(".py")]
    assert [name for name in documents if BY_NAME.search(texts[name])] == []


@pytest.mark.parametrize("repository", ["", "https://example.org/somebody/cutcell"])
def test_links_of_the_package_begin_with_the_repository(repository, tmp_path):
    for name in ("setup.py", "README.md", "LICENSE", "NOTICE"):
        shutil.copy(ROOT / name, tmp_path)
    for name in ("app", "assets", "lab", "viewers"):
        (tmp_path / name).mkdir()
    settings = (ROOT / "pyproject.toml").read_text(encoding="utf-8")
    assert settings.count('\nrepository = ""\n') == 1
    (tmp_path / "pyproject.toml").write_text(
        settings.replace('\nrepository = ""\n', f'\nrepository = "{repository}"\n'),
        encoding="utf-8",
    )
    code = "from setuptools.build_meta import prepare_metadata_for_build_wheel as p; p('.')"
    subprocess.run([sys.executable, "-c", code], cwd=tmp_path, check=True, capture_output=True)
    text = next(tmp_path.glob("cutcell-*.dist-info/METADATA")).read_text(encoding="utf-8")
    links = re.findall(r"\]\(([^)]+)\)", text) + re.findall(r"^Project-URL: \w+, (.*)$", text, re.M)
    elsewhere = [link for link in re.findall(r"\]\(([^)]+)\)", README) if link.startswith("http")]
    ours = [link for link in links if link not in elsewhere]
    assert (len(ours) > 13) == bool(repository)
    parts = [
        re.fullmatch(rf"{repository}(?:/(?:blob|raw)/main/(.*)|/issues|)", one) for one in ours
    ]
    assert all(parts), ours
    files = [part[1].partition("#")[0] for part in parts if part and part[1]]
    assert [name for name in files if not (ROOT / name).exists()] == []


def test_the_front_page_takes_blocks_that_the_readme_has():
    front = (ROOT / "docs" / "index.md").read_text(encoding="utf-8")
    marks = re.findall(r":(?:start-after|end-before): (.*)", front)
    assert len(marks) == 4
    assert [mark for mark in marks if README.count(mark) != 1] == []
    for name in ("who", "answers"):
        block = README.partition(f"<!-- {name} -->")[2].partition(f"<!-- /{name} -->")[0]
        assert block.count("\n- **") >= 3
