"""Graph, Geodesics, Weights and the inspector in a browser, used as a person uses them."""

import re
import shutil

import numpy as np
import pytest
from playwright.sync_api import expect, sync_playwright

import cutcell
from assets import demo_path
from scripts.get_chromium import FLAGS
from tests.app.browser import BIND_MS, LOAD_MS, Visit, changed, served
from tests.conftest import SHARED_RIGS

ROBOT = demo_path("robot")


@pytest.fixture(scope="module")
def browser(chromium):
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=chromium, args=list(FLAGS))
        yield browser
        browser.close()


@pytest.fixture(scope="module")
def url():
    with served(str(ROBOT)) as url:
        yield url


@pytest.fixture(scope="module")
def robot():
    return cutcell.load(ROBOT)


@pytest.fixture
def visit(browser, url):
    visit = Visit(browser, url)
    visit.wait_until_bound()
    visit.expect_text("nearest bones")  # the robot's ring, which no bone reaches
    visit.dismiss()
    yield visit
    visit.close()


def card(visit):
    return visit.page.get_by_role("region", name=re.compile("Vertex"))


def click_vertex(visit, code="true"):
    """Click a vertex of the body for which the click means that vertex; return its index."""
    found = visit.page.evaluate(
        """(code) => {
          const view = window.__cutcell
          const wanted = new Function("vertex", `return ${code}`)
          const points = view.stage.figures.get("body").rest.length / 3
          const box = view.overlay.canvas.getBoundingClientRect()
          for (let vertex = 0; vertex < points; vertex++) {
            if (!wanted(vertex)) { continue }
            const [x, y] = view.vertexPoint(vertex)
            const hit = view.pointer.under(x - box.left, y - box.top)
            if (hit?.vertex !== undefined && wanted(hit.vertex)) { return [hit.vertex, x, y] }
          }
        }""",
        code,
    )
    assert found, "no such vertex is in sight"
    visit.page.mouse.click(found[1], found[2])
    card(visit).wait_for(timeout=LOAD_MS)
    return found[0]


def test_a_vertex_is_looked_at_closely(visit, robot):
    binding = cutcell.bind(robot)
    vertex = click_vertex(visit)
    expect(card(visit)).to_contain_text(f"Vertex {vertex:,}", timeout=LOAD_MS)
    strongest = int(binding.weights[vertex].argmax())
    name, weight = robot.skeleton.names[strongest], binding.weights[vertex, strongest]
    row = card(visit).get_by_role("button", name=f"{name}: weight {weight:.2f}")
    expect(row).to_be_visible()
    expect(card(visit)).to_contain_text("nearest bones")
    assert visit.report()["actors"]["vertex"]["visible"]
    row.click()
    visit.expect_text(f"Weight of {name}")
    visit.page.keyboard.press("Escape")
    expect(card(visit)).to_have_count(0, timeout=LOAD_MS)
    visit.settle()
    assert "vertex" not in visit.report()["actors"]


def test_a_vertex_that_no_bone_reaches_says_why(visit, robot):
    lost = np.flatnonzero(cutcell.bind(robot).distances.fallback)
    click_vertex(visit, f"{lost.tolist()}.includes(vertex)")
    expect(card(visit)).to_contain_text("no path through the body leads from a bone")
    expect(card(visit)).to_contain_text(re.compile(r"Part \d+ of \d+"))
    card(visit).get_by_role("button", name="Close the vertex").click()
    expect(card(visit)).to_have_count(0, timeout=LOAD_MS)


def test_the_graphs_layers_are_counted_and_coloured(visit, robot):
    visit.panel("Graph")
    graph = cutcell.bind(robot).graph
    for kind in range(3):
        visit.expect_text(f"{(graph.edge_kind == kind).sum():,}")
    kinds = visit.look()
    visit.button("By depth").click()
    visit.expect_text("Depth below the surface")
    depth = visit.look()
    assert changed(kinds, depth) > 0.005
    visit.button("By distance").click()
    visit.expect_text("Distance from")
    assert changed(depth, visit.look()) > 0.005


def test_a_slab_and_a_slice_with_its_rays(visit):
    visit.panel("Graph")
    visit.button("Cut Z").click()
    face = visit.look()
    visit.button("Slab", exact=True).click()
    slab = visit.look()
    assert changed(face, slab) > 0.005
    visit.switch("One slice and its rays")
    visit.expect_text("Winding number")
    slice_ = visit.look()
    assert changed(slab, slice_) > 0.01
    assert visit.report()["actors"]["slice crossings"]["points"] > 0
    told = visit.page.evaluate(
        """() => {
          const view = window.__cutcell
          const figure = view.stage.figures.get("slice rays")
          for (let i = 0; i < figure.rest.length / 3; i += 8) {
            const [x, y] = view.stage.project([...figure.rest.slice(3 * i, 3 * i + 3)])
            const text = view.pointer.surfaceReading(x, y)
            if (text && text.startsWith("winding number 1")) { return text }
          }
        }"""
    )
    assert told == "winding number 1"
    visit.slide("Where the slice lies", "ArrowRight", 12)
    assert changed(slice_, visit.look()) > 0.003


def test_connectivity_and_threshold_build_the_graph_again(visit):
    visit.panel("Graph")
    status = visit.page.get_by_text(re.compile(r"interior, .* surface"))
    before = status.inner_text()
    visit.button("26 diagonals").click()
    expect(status).not_to_have_text(before, timeout=BIND_MS)
    assert interior(status.inner_text()) > interior(before)


def interior(status):
    return int(re.search(r"([\d,]+) interior", status)[1].replace(",", ""))


def test_the_field_its_starts_and_the_way_back(visit):
    visit.panel("Distance")
    visit.expect_text("Distance from")
    whole = visit.look()
    visit.switch("Where distances begin")
    visit.expect_text(re.compile(r"\d+ sources, up to 0\.\d+ from the bone"))
    assert visit.report()["actors"]["sources"]["points"] > 0
    visit.switch("Where distances begin")
    click_vertex(visit, "__cutcell.stage.figures.get('body').values[vertex] < 0.04")
    visit.expect_text(re.compile(r"way back, \d\.\d+ long"))
    assert visit.report()["actors"]["path"]["points"] > 0
    visit.page.keyboard.press("Escape")
    expect(card(visit)).to_have_count(0, timeout=LOAD_MS)
    assert changed(whole, visit.look()) < 0.02  # the canvas has the focus, and shows it
    visit.button("Cut Z").click()
    visit.page.wait_for_function("__cutcell.report().actors.inside", timeout=LOAD_MS)
    assert changed(whole, visit.look()) > 0.01


def test_the_wave_runs_and_halts(visit):
    visit.panel("Distance")
    whole = visit.look()
    visit.switch("Wavefront")
    visit.page.wait_for_function("__cutcell.report().front !== null", timeout=LOAD_MS)
    some = visit.look()
    assert changed(whole, some) > 0.01
    front = visit.report()["front"]
    visit.slide("How far it came", "ArrowRight", 8)
    visit.page.wait_for_function("f => __cutcell.report().front > f", arg=front, timeout=LOAD_MS)
    visit.button("Let it run").click()
    visit.page.wait_for_function("__cutcell.report().filming", timeout=LOAD_MS)
    messages = visit.report()["messages"]
    first = visit.report()["front"]
    visit.page.wait_for_function("f => __cutcell.report().front !== f", arg=first, timeout=LOAD_MS)
    assert visit.report()["messages"] == messages  # nothing is streamed
    visit.button("Halt the wave").click()
    visit.page.wait_for_function("!__cutcell.report().filming", timeout=LOAD_MS)
    visit.settle()
    visit.switch("Wavefront")
    assert changed(whole, visit.look()) < 0.002


def test_weights_in_many_ways(visit):
    visit.panel("Weights")
    mixed = visit.look()
    for option, legend in (
        ("The strongest bone", None),
        ("The chosen bone", "Weight of"),
        ("How many bones hold a point", "Joints that a vertex follows"),
    ):
        before = visit.look()
        visit.choose("Colours show", option)
        if legend:
            visit.expect_text(legend)
        assert changed(before, visit.look()) > 0.001, option
    one = visit.look()
    visit.slide("Bones a vertex, at most", "Home")
    visit.expect_text("1.0 bones a vertex")
    assert changed(one, visit.look()) > 0.0005
    for _ in range(3):
        visit.slide("Bones a vertex, at most", "ArrowRight")
        visit.settle()
    visit.choose("Colours show", "All bones")
    assert changed(mixed, visit.look()) < 0.001


def test_a_real_character_on_every_panel(visit, tmp_path):
    real = SHARED_RIGS / "webxr_hand_right.glb"
    source = real if real.exists() else demo_path("rabbit")
    path = tmp_path / "theirs.glb"
    shutil.copy(source, path)
    rig = cutcell.load(path)
    visit.drop(path)
    visit.expect_text(re.compile(f"^{len(rig.mesh.vertices):,} vertices"))
    visit.wait_until_bound()
    visit.choose("Colours show", "Difference to the file's own")
    visit.expect_text("Weight that sits on other joints")
    vertex = click_vertex(visit)
    expect(card(visit)).to_contain_text("outlined: the file's own")
    assert f"Vertex {vertex:,}" in card(visit).inner_text()
    visit.panel("Graph")
    visit.switch("One slice and its rays")
    visit.expect_text("Winding number")
    visit.panel("Distance")
    visit.expect_text("Distance from")
    visit.settle()
    assert visit.report()["actors"]["body"]["visible"]
