"""A notebook: what it shows of each object, and its page, whose joint and vertex Python reads."""

import base64
import json
import os
import shutil
import subprocess
import sys

import nbformat
import pytest
from playwright.sync_api import expect

import cutcell
from cutcell.io.interactive import Page
from cutcell.runtime import compile_cache
from cutcell.weights.warm_up import is_compiled, warm_up
from cutcell_app.headless import notebook_widget
from cutcell_app.headless.interactive import interactive_page
from cutcell_app.headless.notebook_widget import PageWidget
from tests.app.browser import IN_SIGHT, Visit

pytestmark = pytest.mark.nightly

HTML = "text/html"
WIDGET = "application/vnd.jupyter.widget-view+json"
SECONDS = 600
MAX_HEIGHT = 400
NOT_COMPILED = ("_find_edges-", "_prune-")
"""How the files of functions begin that a binding compiles in a moment."""

SETUP = """from pathlib import Path
from cutcell.runtime import compile_cache
compile_cache.folders = lambda: (Path({!r}),)"""
CELLS = (
    "import cutcell\nrig = cutcell.load({!r})\nrig",
    "rig.mesh",
    "rig.skeleton",
    "binding = cutcell.bind(rig)\nbinding",
    "binding.graph",
    "binding.distances",
    "cutcell.show(rig, binding)",
    "cutcell.bind(rig, method='paper')",
)
BIND, SHOW = 3, 6
"""The cells that compile first, and that show the page."""

# The page's policy forbids what Playwright's own waiting does: to evaluate text.
DRAWN = """async () => {
  while (!window.__cutcell?.messages || !__cutcell.report().idle) {
    await new Promise(requestAnimationFrame)
  }
}"""

# A notebook with one widget: what it saves is added to `saved`.
NOTEBOOK = """<!doctype html><div id="output" style="width: 800px"></div>
<script type="module">
import widget from "data:text/javascript;base64,%s"
const [state, listeners, changes] = [%s, {}, {}]
window.saved = []
window.model = {
  get: (name) => state[name],
  set(name, value) {
    if (state[name] === value) { return }
    state[name] = changes[name] = value
    listeners[`change:${name}`]?.forEach((act) => act())
  },
  on: (event, act) => { (listeners[event] ??= new Set()).add(act) },
  off: (event, act) => listeners[event].delete(act),
  save_changes() {
    window.saved.push({...changes})
    for (const name in changes) { delete changes[name] }
  },
}
window.leave = widget.render({model: window.model, el: document.getElementById("output")})
window.listening = () => Object.values(listeners).reduce((sum, {size}) => sum + size, 0)
</script>"""


@pytest.fixture(scope="module")
def outputs(small_path, tmp_path_factory):
    """Run the cells on a machine that has yet to compile two functions; return their outputs."""
    if not is_compiled():
        warm_up()
    folder = tmp_path_factory.mktemp("notebook")
    compiled = next(path for path in compile_cache.folders() if (path / "complete").exists())
    (kernels := folder / "kernels").mkdir()
    left_out = {path for name in NOT_COMPILED for path in compiled.glob(f"{name}*")}
    assert len(left_out) >= len(NOT_COMPILED)
    for path in set(compiled.glob("*.kernel")) - left_out:  # others may be written meanwhile
        shutil.copy(path, kernels)
    first, *others = CELLS
    cells = [SETUP.format(str(kernels)), first.format(str(small_path)), *others]
    notebook = nbformat.v4.new_notebook(cells=list(map(nbformat.v4.new_code_cell, cells)))
    path = folder / "notebook.ipynb"
    nbformat.write(notebook, path)
    # Not in this process, which closes no sockets. No user's kernels and settings are used.
    names = "IPYTHONDIR", "JUPYTER_CONFIG_DIR", "JUPYTER_DATA_DIR", "JUPYTER_RUNTIME_DIR"
    environment = {**os.environ, **{name: str(folder / name) for name in names}}
    command = [sys.executable, "-c", "from nbclient.cli import main; main()"]
    command += ["--inplace", f"--timeout={SECONDS}", str(path)]
    done = subprocess.run(command, env=environment, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    return [cell.outputs for cell in nbformat.read(path, as_version=4).cells[1:]]


def result(cell):
    """Return the one result of a cell by its types."""
    (data,) = [output.data for output in cell if output.output_type == "execute_result"]
    return data


def test_a_first_compile_is_announced_once_where_it_happens(outputs):
    texts = ["".join(one.get("text", "") for one in cell) for cell in outputs]
    assert texts[BIND].strip() == compile_cache.ANNOUNCEMENT
    assert not any(text for number, text in enumerate(texts) if number != BIND)


def test_each_object_is_a_short_table(outputs, browser):
    tables = [result(cell)[HTML] for cell in outputs[:SHOW]]
    names = ["Rig", "TriangleMesh", "Skeleton", "Binding", "CutCellGraph", "BoneDistances"]
    page = browser.new_page()
    page.set_content("".join(f'<div style="width: 800px">{table}</div>' for table in tables))
    assert page.locator("caption").all_inner_texts() == names
    for table in page.locator("table").all():
        box = table.bounding_box()
        assert 40 < box["height"] < MAX_HEIGHT
        assert box["width"] < 800
    page.close()


class Framed(Visit):
    """A notebook whose page is in its only frame."""

    def __init__(self, browser, content, path):
        path.write_text(content, encoding="utf-8")
        super().__init__(browser, path.as_uri())
        self.page.wait_for_selector("iframe")
        self.frame = self.page.frame_locator("iframe")
        expect(self.frame.get_by_role("application")).to_be_visible()
        self.inside = self.page.frames[1]
        self.settle()

    def settle(self):
        """Wait until what was chosen is drawn."""
        self.inside.evaluate(DRAWN)

    @property
    def joint(self):
        """The list of joints."""
        return self.frame.get_by_role("combobox", name="Joint")

    def check(self):
        """Check that nothing was requested but the file itself."""
        assert [url for url in self.requests if url.startswith("http")] == []
        assert self.complaints == []


def test_the_page_in_an_output_is_interactive(outputs, browser, tmp_path):
    data = result(outputs[SHOW])
    assert WIDGET not in data, "it would be shown instead, and be empty offline"
    content = f'<!doctype html><div style="width: 800px">{data[HTML]}</div>'
    visit = Framed(browser, content, tmp_path / "output.html")
    assert visit.page.locator("iframe").bounding_box()["width"] == 800
    before = visit.frame.get_by_role("application").screenshot()
    visit.joint.select_option("2")
    visit.settle()
    assert visit.frame.get_by_role("application").screenshot() != before
    visit.close()


@pytest.fixture
def widget(small, monkeypatch):
    page = Page(interactive_page(small, cutcell.bind(small)))
    widget = PageWidget(small, page)
    monkeypatch.setattr(notebook_widget, "is_attended", lambda: True)
    data, _ = widget._repr_mimebundle_()
    assert {WIDGET, HTML} <= set(data)
    yield widget
    widget.close()


def test_joint_and_vertex_are_those_of_python(widget, browser, tmp_path):
    names = ("content", "height", "joint", "vertex")
    script = base64.b64encode(str(widget._esm).encode()).decode()
    state = json.dumps(widget.get_state(names)).replace("<", r"\u003c")
    visit = Framed(browser, NOTEBOOK % (script, state), tmp_path / "notebook.html")
    inside, page = visit.inside, visit.page

    def saved():
        """Give Python what the page saved, as the transport of a notebook does."""
        visit.settle()
        page.wait_for_function("saved.length")
        (changes,) = page.evaluate("saved.splice(0)")
        widget.set_state(changes)
        return changes

    def choose(**choice):
        """Choose in Python."""
        for name, value in choice.items():
            setattr(widget, name, value)
            page.evaluate("([name, value]) => model.set(name, value)", [name, value])

    expect(visit.joint).to_have_value(str(widget.joint))
    visit.joint.select_option("2")
    assert saved() == {"joint": 2}
    assert widget.joint == 2
    visit.joint.select_option(label="All joints")
    assert saved() == {"joint": None}
    assert widget.joint is None

    vertex, x, y = inside.evaluate(IN_SIGHT, "true")
    frame = page.locator("iframe").bounding_box()
    page.mouse.click(frame["x"] + x, frame["y"] + y)
    assert saved() == {"vertex": vertex}
    assert widget.vertex == vertex
    card = visit.frame.get_by_role("region", name=f"Vertex {vertex}")
    expect(card).to_be_visible()

    choose(joint=3)
    expect(visit.joint).to_have_value("3")
    choose(vertex=None)
    expect(card).to_have_count(0)
    assert page.evaluate("saved") == [], "what Python chose does not come back"
    assert page.evaluate("listening()") == 2
    page.evaluate("leave()")
    assert page.evaluate("listening()") == 0
    visit.close()
