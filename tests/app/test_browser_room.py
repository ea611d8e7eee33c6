"""What lies over the canvas of a wide window leaves the character free."""

import pytest
from playwright.sync_api import expect

pytestmark = pytest.mark.slow

WIDE = {"width": 1440, "height": 900}

# How many points of the body at rest are seen behind an element of the page.
BEHIND = """(element) => {
  const {renderer, overlay} = window.__cutcell
  const canvas = overlay.canvas.getBoundingClientRect()
  const {left, right, top, bottom} = element.getBoundingClientRect()
  const {rest} = renderer.actors.get("body")
  let behind = 0
  for (let i = 0; i < rest.length; i += 3) {
    const [x, y] = renderer.project([rest[i], rest[i + 1], rest[i + 2]])
    const across = canvas.left + x >= left && canvas.left + x <= right
    behind += across && canvas.top + y >= top && canvas.top + y <= bottom
  }
  return behind
}"""
TOP_AND_BOTTOM = """() => {
  const {renderer} = window.__cutcell
  const {rest} = renderer.actors.get("body")
  let [top, bottom] = [Infinity, -Infinity]
  for (let i = 0; i < rest.length; i += 3) {
    const y = renderer.project([rest[i], rest[i + 1], rest[i + 2]])[1]
    top = Math.min(top, y)
    bottom = Math.max(bottom, y)
  }
  return [top, bottom]
}"""
MIDDLE = "__cutcell.renderer.insets.left - __cutcell.renderer.insets.right"


@pytest.fixture
def wide(visit):
    """Show the page in a wide window for a while."""
    narrow = visit.page.viewport_size
    visit.page.set_viewport_size(WIDE)
    yield visit
    visit.page.set_viewport_size(narrow)


def behind(visit, place):
    place.wait_for()
    visit.settle()
    return place.evaluate(BEHIND)


def test_on_a_telephone_on_its_side_the_legend_is_beside_the_character(visit):
    before = visit.page.viewport_size
    visit.page.set_viewport_size({"width": 844, "height": 390})
    visit.panel("Distance")
    assert behind(visit, visit.page.locator(".legend")) == 0
    top, bottom = visit.page.evaluate(TOP_AND_BOTTOM)
    canvas = visit.page.get_by_role("application").bounding_box()
    assert bottom - top > 0.5 * canvas["height"]
    visit.page.set_viewport_size(before)


@pytest.mark.parametrize("demo", ["rabbit", "biped"])
def test_nothing_over_a_wide_canvas_hides_a_part_of_the_character(wide, demo):
    visit = wide
    visit.go(f"?rig={demo}&resolution=16")
    for place in (".legend", ".hint", ".tools"):
        assert behind(visit, visit.page.locator(place)) == 0, place
    home = visit.page.evaluate(MIDDLE)
    visit.click_vertex()
    visit.settle()
    moved = visit.page.evaluate(MIDDLE) != home
    assert moved == (demo == "rabbit"), "no farther aside than it must"
    if moved:  # and with it what the pointer rested on
        expect(visit.page.locator(".bone")).to_be_hidden()
    assert behind(visit, visit.card) == 0
    assert behind(visit, visit.page.locator(".legend")) == 0
    visit.close_card()
    visit.settle()
    assert visit.page.evaluate(MIDDLE) == home
    visit.panel("Pose")
    visit.button("Play").click()
    visit.page.wait_for_function("__cutcell.report().playing")
    bar = visit.page.locator(".transport")
    expect(bar).to_be_visible()
    visit.button("Pause the motion").click()
    assert behind(visit, bar) == 0


def test_a_notice_hides_no_head_and_the_legend_gives_way(wide):
    visit = wide
    visit.go("?rig=biped_cape&resolution=16")
    assert behind(visit, visit.page.get_by_role("alert")) == 0
    visit.dismiss()
    visit.settle()
    assert visit.page.evaluate("__cutcell.renderer.insets.top") == 20
    # Moved to where the legend is, the character is seen whole.
    legend = visit.page.locator(".legend")
    own = legend.bounding_box()
    x, y = visit.page.evaluate("__cutcell.vertexPoint(0)")
    visit.page.keyboard.down("Shift")
    visit.page.mouse.move(x, y)
    visit.page.mouse.down()
    visit.page.mouse.move(own["x"] + 100, own["y"] - 100, steps=3)
    visit.page.mouse.up()
    visit.page.keyboard.up("Shift")
    assert behind(visit, legend) == 0
    assert legend.bounding_box()["x"] > own["x"] + 100
    visit.page.get_by_role("application").dblclick(position={"x": 600, "y": 30})
    visit.settle()
    assert legend.bounding_box() == own
