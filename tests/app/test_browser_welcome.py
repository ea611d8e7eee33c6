"""The first minute: a welcome with three ways in, a skip link, headings and landmarks."""

import pytest
from playwright.sync_api import expect

from tests.app.browser import LOAD_MS, Visit

pytestmark = pytest.mark.slow

FOCUSED = """() => {
  let part = document.activeElement
  while (part?.shadowRoot?.activeElement) { part = part.shadowRoot.activeElement }
  const role = part.getAttribute("role")
  // The input of a switch or a slider is hidden: what moves with it is outlined.
  const outlined = (one) => getComputedStyle(one).outlineStyle === "solid"
  while (part && !outlined(part)) { part = part.parentElement }
  const style = part && getComputedStyle(part)
  return {role, outline: style?.outlineColor, width: style?.outlineWidth}
}"""


@pytest.fixture(params=[(1100, 720), (390, 844)], ids=["wide", "narrow"])
def first_visit(browser, url, request):
    """Come without an address that says anything."""
    width, height = request.param
    visit = Visit(browser, url, viewport={"width": width, "height": height})
    visit.page.wait_for_function("window.__cutcell?.report().actors.body", timeout=LOAD_MS)
    yield visit
    visit.close()


def test_a_first_visit_is_welcomed_until_it_goes_on(first_visit):
    page = first_visit.page
    welcome = page.get_by_role("region", name="Welcome")
    expect(welcome.get_by_role("button")).to_have_count(4)
    above = welcome.bounding_box()
    canvas = page.get_by_role("application").bounding_box()
    assert above["y"] + above["height"] <= canvas["y"] + 1, "it covers the canvas"
    with page.expect_file_chooser():
        welcome.get_by_role("button", name="Open my character").press("Enter")
    welcome.get_by_role("button", name="See why weights leak").press("Enter")
    expect(welcome).to_be_hidden()
    expect(page.get_by_role("article", name="Tour")).to_contain_text("Step 3")
    page.goto(first_visit.url)
    page.wait_for_function("window.__cutcell?.report().actors.body", timeout=LOAD_MS)
    expect(welcome).to_have_count(0)


def test_a_link_skips_the_controls(visit):
    page = visit.page
    page.evaluate("document.activeElement.blur()")
    link = page.get_by_role("link", name="Skip to the canvas")
    link.focus()
    expect(link).to_be_in_viewport()
    page.keyboard.press("Enter")
    focused = page.evaluate(FOCUSED)
    assert focused["role"] == "application"
    expect(link).not_to_be_in_viewport()


def test_the_page_has_one_first_heading_and_named_landmarks(visit):
    page = visit.page
    expect(page.get_by_role("heading", level=1)).to_have_text("cutcell")
    for role in ("main", "navigation"):
        assert page.get_by_role(role).get_attribute("aria-label")


def test_focus_looks_the_same_everywhere(visit):
    page = visit.page
    looks = {}
    for role, name in (("tab", "Weights"), ("button", "Animation"), ("switch", "Paint"),
                       ("slider", "Max influences"), ("button", "Brush"), ("button", "Open"),
                       ("button", "Reset all choices")):  # fmt: skip
        page.get_by_role(role, name=name, exact=True).first.focus()
        page.keyboard.press("Shift")  # by keyboard, not by a program
        focused = page.evaluate(FOCUSED)
        looks[name] = focused["outline"], focused["width"]
    assert set(looks.values()) == {("rgb(224, 90, 0)", "2px")}, looks


def test_sections_open_when_they_are_needed(visit):
    heading = visit.button("Brush")
    heading.press("Enter")
    expect(heading).to_have_attribute("aria-expanded", "false")
    expect(visit.page.get_by_role("switch", name="Paint")).to_be_hidden()
    visit.page.get_by_role("application").press("b")
    expect(heading).to_have_attribute("aria-expanded", "true")
    expect(visit.page.get_by_role("switch", name="Paint")).to_be_checked()
