"""The interactive page in one file, opened from the disk."""

import html
import re

import numpy as np
import pytest
from playwright.sync_api import expect

import cutcell
from cutcell_app.headless.interactive import interactive_page
from tests.app.browser import Visit, changed
from tests.app.small import RESOLUTION
from tests.app.test_browser_rendered import from_afar

MAX_BYTES = 10_000_000
# The page's policy forbids what Playwright's own waiting does: to evaluate text.
WAIT = """async () => {{
  while (!window.__cutcell?.messages || !({})) {{ await new Promise(requestAnimationFrame) }}
}}"""
CAMERA = "({position: __cutcell.insets.position, focal_point: __cutcell.orbit.target})"
LOOK = "camera => __cutcell.receive({id: 1e6, camera})"
SCENE_ALONE = """(alone) => {
  for (const shown of __cutcell.overlay.root.children) {
    if (shown !== __cutcell.overlay.canvas) { shown.style.opacity = alone ? 0 : "" }
  }
}"""
FRAMED = '<!doctype html><iframe width="320" height="240" srcdoc="{}"></iframe>'


class Alone(Visit):
    """A page without a server, which draws by itself."""

    def __init__(self, browser, url, **context):
        super().__init__(browser, url, draws=True, **context)

    def settle(self):
        """Wait until what was chosen is drawn."""
        self.page.evaluate(WAIT.format("__cutcell.report().idle"))

    def select(self, label, value):
        """Take an option of a list by its value."""
        self.page.get_by_role("combobox", name=label).select_option(str(value))

    def resize(self, width, height):
        """Give the canvas a size, in pixels."""
        self.page.set_viewport_size({"width": width, "height": 2 * height})
        canvas = self.page.get_by_role("application").bounding_box()
        controls = 2 * height - round(canvas["height"])
        self.page.set_viewport_size({"width": width, "height": height + controls})
        self.settle()

    def check(self):
        """Check that nothing was requested but the file itself."""
        inline = ("data:", "blob:", "about:")
        requests = [url for url in self.requests if not url.startswith(inline)]
        assert requests == [self.url]
        assert self.complaints == []


@pytest.fixture(scope="module")
def binding(small):
    return cutcell.bind(small, RESOLUTION)


@pytest.fixture(scope="module")
def path(small, binding, tmp_path_factory):
    path = tmp_path_factory.mktemp("interactive") / "small.html"
    path.write_text(interactive_page(small, binding), encoding="utf-8")
    return path


@pytest.fixture
def alone(browser, path):
    alone = Alone(browser, path.as_uri())
    alone.settle()
    yield alone
    alone.close()


def test_joints_views_and_vertices_are_shown_without_a_server(alone, path, binding):
    assert path.stat().st_size < MAX_BYTES
    first = alone.look()
    joints = np.argsort(-binding.weights.sum(axis=0))
    alone.select("Joint", joints[0])
    weights = alone.look()
    assert changed(first, weights) > 0.01
    alone.button("Distance").click()
    assert changed(weights, alone.look()) > 0.01
    vertex = alone.click_vertex()
    strongest = int(binding.weights[vertex].argmax())
    shown = alone.card.get_by_role("button", name=re.compile("weight"))
    expect(shown.first).to_contain_text(f"{binding.weights[vertex, strongest]:.2f}")
    distance = binding.distances.at(strongest, vertex) * binding.graph.lattice.size
    expect(alone.card).to_contain_text(f"{distance:.3g}")
    alone.close_card()


def test_the_picture_is_the_one_of_the_served_page(visit, alone, small):
    alone.button("Weights").click()
    alone.select("Joint", len(small.skeleton.joints))
    for panel in ("Weights", "Distance"):
        visit.panel(panel)
        served = scene(visit)
        canvas = visit.page.get_by_role("application").bounding_box()
        alone.resize(round(canvas["width"]), round(canvas["height"]))
        alone.button(panel).click()
        if panel == "Distance":
            alone.select("Joint", small.skeleton.names.index(visit.bone.inner_text()))
        alone.page.evaluate(LOOK, visit.page.evaluate(CAMERA))
        difference = np.abs(scene(alone) - served).max(axis=2)
        assert np.abs(served - served[-1, 0]).max() > 100, "something is seen"
        assert (difference > 24).mean() < 3e-3, "the toolbar, no more"


def test_a_clip_plays_and_a_ring_turns_the_joint(alone):
    rest = alone.points()
    alone.select("Clip", 0)
    alone.page.evaluate(WAIT.format("__cutcell.report().time > 0.1"))
    alone.button("Pause the motion").click()
    alone.settle()
    assert np.abs(alone.points() - rest).max() > 1e-3
    alone.select("Clip", -1)
    alone.settle()
    np.testing.assert_array_equal(alone.points(), rest)
    x, y = alone.page.evaluate("__cutcell.gizmo.handle(2)")
    alone.page.mouse.move(x, y)
    alone.page.mouse.down()
    alone.page.mouse.move(x + 40, y + 40)
    alone.page.mouse.up()
    turned = alone.points()
    assert np.abs(turned - rest).max() > 1e-3
    alone.select("Blending", 1)
    alone.settle()
    assert np.abs(alone.points() - turned).max() > 1e-5
    alone.select("Blending", 0)
    alone.button("Reset pose").click()
    np.testing.assert_array_equal(alone.points(), rest)


def test_a_slider_moves_the_cut_of_the_graph(browser, small, binding, tmp_path):
    path = tmp_path / "graph.html"
    path.write_text(interactive_page(small, binding, view="graph"), encoding="utf-8")
    alone = Alone(browser, path.as_uri())
    cut = alone.look()
    alone.slide("Position of the cut", "Home")
    assert changed(cut, alone.look()) > 0.05
    assert alone.report()["actors"]["interior edges"]["cells"] > 100
    alone.slide("Position of the cut", "End")
    alone.click_vertex()
    alone.button("Weights").click()
    alone.settle()
    assert "vertex" in alone.report()["actors"]
    alone.close()


def test_it_fits_a_small_frame_and_follows_the_dark_theme(browser, path, tmp_path):
    page = tmp_path / "frame.html"
    page.write_text(FRAMED.format(html.escape(path.read_text(encoding="utf-8"))), encoding="utf-8")
    alone = Alone(browser, page.as_uri(), color_scheme="dark")
    frame = alone.page.frame_locator("iframe")
    expect(frame.get_by_role("application")).to_be_visible()
    inside = alone.page.frames[1]
    inside.evaluate(WAIT.format("__cutcell.report().actors.body"))
    sizes = "[document.documentElement.scrollWidth, document.documentElement.scrollHeight]"
    assert inside.evaluate(sizes) == [320, 240]
    color = "getComputedStyle(document.body).backgroundColor"
    assert inside.evaluate(color) == "rgb(27, 32, 40)"
    alone.close()


def scene(visit):
    """Return the picture from afar, without what is written over it."""
    visit.settle()
    visit.page.evaluate(SCENE_ALONE, True)
    picture = visit.look()
    visit.page.evaluate(SCENE_ALONE, False)
    return from_afar(picture)
