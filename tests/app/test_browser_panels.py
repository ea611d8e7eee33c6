"""Graph, Geodesics, Weights and the inspector in a browser, used as a person uses them."""

import re

import pytest
from playwright.sync_api import expect

import cutcell
from tests.app.browser import changed
from tests.app.small import FINE, RESOLUTION

pytestmark = pytest.mark.slow


def test_a_vertex_is_looked_at_closely(visit, small):
    binding = cutcell.bind(small, RESOLUTION)
    vertex = visit.click_vertex()
    expect(visit.card).to_contain_text(f"Vertex {vertex:,}")
    strongest = int(binding.weights[vertex].argmax())
    name, weight = small.skeleton.names[strongest], binding.weights[vertex, strongest]
    row = visit.card.get_by_role("button", name=f"{name}: weight {weight:.2f}")
    expect(row).to_be_visible()
    expect(visit.card).to_contain_text("nearest bones")
    assert visit.report()["actors"]["vertex"]["visible"]
    visit.card.get_by_role("button", name="Why these weights?").click()
    answer = visit.card.locator("details").first
    expect(answer).to_contain_text(f"{name}{weight:.2f}")
    expect(answer).to_contain_text("normalised")
    visit.page.wait_for_function(
        "joint => `path to ${joint}` in __cutcell.report().actors", arg=strongest
    )
    visit.card.get_by_role("button", name="Hide why").click()
    expect(answer).to_have_count(0)
    row.click()
    visit.expect_text(f"Weight of {name}")
    visit.close_card()
    visit.settle()
    assert "vertex" not in visit.report()["actors"]


def test_the_graphs_layers_are_counted_and_coloured(visit, small):
    visit.panel("Graph")
    graph = cutcell.bind(small, RESOLUTION).graph
    for kind in range(3):
        visit.expect_text(f"{(graph.edge_kind == kind).sum():,}")
    kinds = visit.look()
    visit.button("Depth").click()
    visit.expect_text("Depth below the surface")
    depth = visit.look()
    assert changed(kinds, depth) > 0.005
    visit.button("Distance").first.click()
    visit.expect_text("Distance from")
    assert changed(depth, visit.look()) > 0.005


def test_a_slab_and_a_slice_with_its_rays(visit):
    visit.go(FINE)
    visit.panel("Graph")
    visit.button("Cut Z").click()
    face = visit.look()
    visit.button("Slab", exact=True).click()
    slab = visit.look()
    assert changed(face, slab) > 0.001
    visit.switch("One slice and its rays")
    visit.expect_text("Winding number")
    slice_ = visit.look()
    assert changed(slab, slice_) > 0.01
    assert visit.report()["actors"]["slice crossings"]["points"] > 0
    reports = visit.page.evaluate(
        """() => {
          const view = window.__cutcell
          const actor = view.renderer.actors.get("slice rays")
          for (let i = 0; i < actor.rest.length / 3; i += 8) {
            const [x, y] = view.renderer.project([...actor.rest.slice(3 * i, 3 * i + 3)])
            const text = view.pointer.surfaceReading(x, y)
            if (text && text.startsWith("winding number 1")) { return text }
          }
        }"""
    )
    assert reports == "winding number 1"
    visit.slide("Position", "PageUp", 3)
    assert changed(slice_, visit.look()) > 0.003


def test_the_field_its_starts_and_the_way_back(visit):
    visit.panel("Distance")
    visit.expect_text("Distance from")
    whole = visit.look()
    visit.switch("Sources")
    visit.expect_text(re.compile(r"\d+ sources, up to [\d.]+ \w+ from the bone"))
    assert visit.report()["actors"]["sources"]["points"] > 0
    visit.switch("Sources")
    visit.click_vertex("Number.isFinite(__cutcell.renderer.actors.get('body').values[vertex])")
    visit.expect_text(re.compile(r"shortest path, [\d.]+ \w+"))
    assert visit.report()["actors"]["path"]["points"] > 0
    visit.close_card()
    assert changed(whole, visit.look()) < 0.02  # the canvas has the focus, and shows it
    visit.button("Cut Z").click()
    visit.page.wait_for_function("__cutcell.report().actors.inside")
    assert changed(whole, visit.look()) > 0.01
    across = visit.page.evaluate("__cutcell.cut.normal")
    knob = visit.page.locator(".cut-handles .knob.turn").bounding_box()
    visit.page.mouse.move(knob["x"] + 6, knob["y"] + 6)
    visit.page.mouse.down()
    visit.page.mouse.move(knob["x"] + 66, knob["y"] + 6, steps=3)
    visit.page.mouse.up()
    visit.page.wait_for_function("n => __cutcell.cut.normal[0] !== n[0]", arg=across)
    visit.slide("Pitch", "ArrowRight", 2)
    visit.button("Winding number").click()
    visit.expect_text("where the plane meets the mesh")
    visit.switch("Straight line")
    visit.switch("Along voxels")
    visit.button("R = 16").click()
    visit.expect_text("Along voxels, R = 16")
    visit.page.wait_for_function("__cutcell.report().actors.voxels")
    expect(visit.button("Cut Z")).to_have_count(0)
    visit.click_vertex("__cutcell.renderer.actors.get('body').values[vertex] > 0.3")
    visit.expect_text(re.compile(r"^Straight line · \d\.\d+ \w+$"))
    paths = visit.report()["actors"]
    assert paths["path 0"]["points"] != paths["path 1"]["points"]


def test_the_wave_runs_and_halts(visit):
    visit.panel("Distance")
    whole = visit.look()
    visit.switch("Wavefront")
    visit.page.wait_for_function("__cutcell.report().front !== null")
    some = visit.look()
    assert changed(whole, some) > 0.01
    front = visit.report()["front"]
    visit.slide("Progress", "ArrowRight", 8)
    visit.page.wait_for_function("f => __cutcell.report().front > f", arg=front)
    visit.button("Play the wave").click()
    visit.page.wait_for_function("__cutcell.report().animating")
    messages = visit.report()["messages"]
    first = visit.report()["front"]
    visit.page.wait_for_function("f => __cutcell.report().front !== f", arg=first)
    assert visit.report()["messages"] == messages  # nothing is streamed
    visit.button("Pause the wave").click()
    visit.page.wait_for_function("!__cutcell.report().animating")
    visit.settle()
    visit.switch("Wavefront")
    assert changed(whole, visit.look()) < 0.002


def test_weights_in_many_ways(visit):
    visit.panel("Weights")
    mixed = visit.look()
    visit.choose("Colour by", "Influences per vertex")
    visit.expect_text("Influences")
    count = visit.look()
    assert changed(mixed, count) > 0.001
    visit.slide("Max influences", "Home")
    visit.expect_text("1.0 influences per vertex")
    assert changed(count, visit.look()) > 0.0005
    visit.button("Undo").click()
    visit.choose("Colour by", "All bones")
    assert changed(mixed, visit.look()) < 0.001


def test_a_finding_is_shown_where_it_is(visit, small):
    visit.panel("Check")
    lost = cutcell.diagnose(small)["unreachable-vertices"]
    visit.expect_text(lost.message)
    visit.button(lost.title).click()
    visit.expect_text(lost.advice)
    visit.settle()
    expect(visit.button(lost.title)).to_be_focused()
    marks = visit.report()["actors"]
    assert marks["finding faces"]["visible"]
    far = visit.look()
    visit.button(lost.title).click()
    visit.settle()
    assert "finding faces" not in visit.report()["actors"]
    assert changed(far, visit.look()) > 0.005


def test_a_larger_character_is_coloured_all_over(visit):
    visit.choose("Character", "Walker, unwelded and torn")
    visit.page.wait_for_function("location.search.includes('rig=biped_soup')")
    visit.wait_until_bound()
    assert (visit.look().max(axis=2) < 25).mean() < 0.001
