"""The recipes of CONTRIBUTING.md, followed in a copy of the packages."""

import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from cutcell_app.features import FEATURES
from cutcell_app.features.state import PANELS
from tests.test_layers import ROOT

PANEL = """
from cutcell_app.shell.session.begin import begin
from cutcell_app.features import FEATURES
from cutcell_app.widgets.controls import draw
from cutcell_app.headless.choices import Choices
from cutcell_app.headless.scene import describe
from tests.viewers.arm import arm_rig
from tests.app.loop import Loop
loop = Loop()
session = begin(loop)
session.state.param.update(panel="size", rig=arm_rig())
assert draw(session, FEATURES["size"].controls, "size").objects[1].value is True
loop.rest(session)
assert session.state.size > 0
title = session.view._next.legend.title
assert title.startswith("Size")
assert session.view.last_sent("points") == {"size limit": [0, 1, 0]}
session.view._handle_msg({"type": "move-point", "name": "size limit", "position": [0, 0.3, 0]})
assert session.state.size_limit == 0.3
assert session.view.last_sent("points") == {"size limit": [0, 0.3, 0]}
drawn = describe(arm_rig(), Choices("size"), resolution=8)
assert "body" in drawn.actors and drawn.legend.title == title
"""
OPTION = """
from typer.testing import CliRunner
import cutcell
from cutcell.cli.app import app
from cutcell.graph.fingerprint import graph_fingerprint
from cutcell_app.shell.session.begin import begin
from cutcell_app.features import FEATURES
from cutcell_app.widgets.controls import draw
mesh = cutcell.TriangleMesh([[0, 0, 0], [1, 0, 0], [0, 1, 0], [9, 9, 9]], [[0, 1, 2]])
try:
    cutcell.build_graph(mesh, 8, strict=True)
except cutcell.MeshError as error:
    assert "strict" in str(error)
else:
    raise AssertionError("it is not used")
fingerprints = [graph_fingerprint(mesh, cutcell.Method(strict=one)) for one in (True, False)]
assert fingerprints[0] != fingerprints[1]
run = CliRunner(env={"COLUMNS": "120", "TERM": "dumb"}).invoke
assert "--strict" in run(app, ["graph", "--help"]).output
session = begin(lambda act: act())
controls = draw(session, FEATURES["graph"].controls, "graph")
labels = [getattr(one, "name", "") for one in controls.select()]
assert session.state.strict is False and "Reject unused vertices" in labels
"""
METRIC = """
import io
from rich.console import Console
from cutcell_lab.baselines.compare import compare, comparison_markdown
from cutcell_lab.baselines.compare.terminal import comparison_table
from tests.viewers.arm import arm_rig
result = compare([arm_rig()], ["artist", "euclidean"])
assert result.statistic("artist", "influences").median > 0
assert "| influences |" in comparison_markdown(result)
assert result.to_dict()["rigs"][0]["scores"][0]["influences"] > 0
console = Console(width=200, record=True, file=io.StringIO())
console.print(comparison_table(result, 200))
assert "influences" in console.export_text()
"""
FORMAT = """
from pathlib import Path
import cutcell
from cutcell.cli.options import _RIG
from tests.cutcell.io.test_formats import listed
from cutcell.io.formats import FORMATS
Path("a.tri").write_text("# triangles\\n0 0 0 1 0 0 0 1 0\\n")
for source in ("a.tri", Path("a.tri").read_bytes()):
    assert len(cutcell.load(source).mesh.faces) == 1
assert ".tri (triangles as text)" in _RIG.help
assert set(listed(Path("docs/formats.md"))) == {frozenset(f.suffixes) for f in FORMATS}
"""


def files_of(recipe: str) -> dict[str, list[str]]:
    """Return the lines of a recipe by the files that they belong to."""
    text = (ROOT / "CONTRIBUTING.md").read_text(encoding="utf-8")
    block = re.search(rf"^## {recipe}$.*?^```diff\n(.*?)^```$", text, re.M | re.S)
    assert block is not None
    parts = re.split(r"^# (\S+)\n", block[1], flags=re.M)[1:]
    return {path: lines.splitlines() for path, lines in zip(parts[::2], parts[1::2], strict=True)}


def follow(lines: list[str], path: Path) -> None:
    """Insert what is marked by a plus after the lines without one, which must be in the file."""
    content = path.read_text(encoding="utf-8").splitlines() if path.exists() else []
    at = 0
    for line in lines:
        if line.startswith("+"):
            content.insert(at, line[1:])
        else:
            at = content.index(line[1:], at)
        at += 1
    path.parent.mkdir(exist_ok=True)
    path.write_text("\n".join(content) + "\n", encoding="utf-8")


@pytest.mark.slow
@pytest.mark.parametrize(
    ("recipe", "most", "check"),
    [
        ("Adding a panel", 7, PANEL),
        ("Adding an option of the method", 3, OPTION),
        ("Adding a metric", 1, METRIC),
        ("Adding a file format", 2, FORMAT),
    ],
    ids=["panel", "option", "metric", "format"],
)
def test_a_recipe_is_enough(recipe, most, check, tmp_path):
    files = files_of(recipe)
    assert len(files) <= most
    names = {"app": "cutcell_app", "cutcell": "cutcell", "docs": "docs", "lab": "cutcell_lab"}
    for folder, name in names.items():
        unused = shutil.ignore_patterns("__py*", "pictures", "gallery")
        shutil.copytree(ROOT / folder, tmp_path / name, ignore=unused)
    for path, lines in files.items():
        folder, _, below = path.partition("/")
        follow(lines, tmp_path / names[folder] / below)
    places = os.pathsep.join(map(str, (tmp_path, ROOT)))
    done = subprocess.run(
        [sys.executable, "-c", check],
        env={**os.environ, "PYTHONPATH": places},
        cwd=tmp_path,
        capture_output=True,
        text=True,
    )
    assert done.returncode == 0, done.stderr


def test_every_panel_has_a_scene_and_controls():
    for name in PANELS:
        assert callable(FEATURES[name].scene)
        assert FEATURES[name].controls is not None
