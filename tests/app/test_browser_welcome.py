"""The first minute: a welcome with two ways in, a skip link, headings and landmarks."""

import re

import numpy as np
import pytest
from playwright.sync_api import expect

from tests.app.browser import BIND_MS, Visit, changed
from tests.app.small import SMALL
from tests.app.test_browser_private import NARROW, check

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
NOT_COVERED = """([welcome, canvas]) =>
  welcome.getBoundingClientRect().bottom <= canvas.getBoundingClientRect().top + 1"""


def check_welcome(page):
    """Check the welcome of a first visit, and leave it for the lesson."""
    welcome = page.get_by_role("region", name="Welcome")
    expect(welcome.get_by_role("button")).to_have_count(3)
    # A narrow page begins with its sheet open, which hides the welcome until it has closed.
    both = [welcome.element_handle(), page.get_by_role("application").element_handle()]
    page.wait_for_function(NOT_COVERED, arg=both)
    with page.expect_file_chooser():
        welcome.get_by_role("button", name="Open my character").press("Enter")
    welcome.get_by_role("button", name="See why weights leak").press("Enter")
    expect(welcome).to_be_hidden()
    expect(page.get_by_role("article", name="Lesson")).to_contain_text("Step 1")


def check_early_ways_in(page):
    """Check that two keys lead to the welcome, before all controls."""
    link = page.get_by_role("link", name="Skip to the welcome")
    for _ in range(2):
        page.keyboard.press("Tab")
        if link.evaluate("link => link === document.activeElement"):
            break
    expect(link).to_be_in_viewport()
    page.keyboard.press("Enter")
    expect(page.get_by_role("button", name="See why weights leak")).to_be_focused()


def test_a_first_visit_shows_a_moving_character_and_is_welcomed_once(browser, url):
    visit = Visit(browser, url)
    page = visit.page
    # It moves, in the colours of its weights, until somebody halts it.
    visit.status.wait_for(timeout=BIND_MS)
    check_early_ways_in(page)
    page.wait_for_function("__cutcell.report().playing && __cutcell.report().time > 0.2")
    visit.button("Pause the motion").click()
    seen = visit.look()
    assert page.evaluate("__cutcell.renderer.actors.get('body').coloured")
    assert page.get_by_role("combobox", name="Character").inner_text() == "Walker"
    assert visit.report()["actors"]["body"]["visible"]
    assert len(np.unique(seen.reshape(-1, 3), axis=0)) > 1000
    visit.panel("Graph")
    assert changed(seen, visit.look()) > 0.05
    check_welcome(page)
    expect(page.get_by_role("link", name="Skip to the welcome")).to_have_count(0)
    page.goto(visit.url)
    page.wait_for_function("window.__cutcell?.report().actors.body")
    expect(page.get_by_role("region", name="Welcome")).to_have_count(0)
    visit.close()


def test_a_narrow_window_shows_the_canvas_first_and_the_systems_theme(browser, url, tmp_path):
    size = {"width": 420, "height": 800}
    visit = Visit(browser, url, viewport=size, color_scheme="dark")
    # It moves: there is no rest to wait for.
    visit.page.wait_for_function("window.__cutcell?.report().actors.body")
    check_welcome(visit.page)
    visit.button("Leave").click()
    visit.go(SMALL.removeprefix("/"))
    visit.button("Open drawer").wait_for()
    assert visit.look()[-2, 2].max() < 80
    box = visit.page.get_by_role("application").bounding_box()
    assert box["width"] > 400
    assert box["height"] > 400
    visit.button("Open drawer").click()
    check(visit, NARROW)
    visit.panel("Graph")
    visit.page.get_by_role("switch", name="Mesh edges").wait_for()
    # A sheet at the bottom: what its switches change is seen above it, and can be turned.
    canvas = visit.page.locator(".canvas").bounding_box()
    sheet = visit.page.locator(".MuiDrawer-paper").bounding_box()
    assert canvas["height"] > 250
    assert canvas["y"] + canvas["height"] <= sheet["y"]
    camera = visit.report()["camera"]
    visit.page.mouse.move(200, 250)
    visit.page.mouse.down()
    visit.page.mouse.move(260, 250, steps=3)
    visit.page.mouse.up()
    visit.settle()
    assert visit.report()["camera"] != camera
    # What went wrong is not told behind the sidebar.
    bad = tmp_path / "bad.glb"
    bad.write_text("this is not a character")
    visit.drop(bad)
    visit.expect_text(re.compile(r"bad\.glb"))
    expect(visit.page.locator(".MuiDrawer-paper")).to_have_count(0)
    visit.dismiss()
    visit.close()


def test_landmarks_are_named_and_a_link_skips_the_controls(visit):
    page = visit.page
    expect(page.get_by_role("heading", level=1)).to_have_text("cutcell")
    for role in ("main", "navigation"):
        assert page.get_by_role(role).get_attribute("aria-label")
    page.evaluate("document.activeElement.blur()")
    link = page.get_by_role("link", name="Skip to the canvas")
    link.focus()
    expect(link).to_be_in_viewport()
    page.keyboard.press("Enter")
    focused = page.evaluate(FOCUSED)
    assert focused["role"] == "application"
    expect(link).not_to_be_in_viewport()


def test_focus_looks_the_same_everywhere(visit):
    page = visit.page
    looks = {}
    controls = {
        name: page.get_by_role(role, name=name, exact=True).first
        for role, name in (
            *(("tab", "Weights"), ("button", "Animation"), ("switch", "Paint")),
            *(("slider", "Max influences"), ("button", "Brush"), ("button", "Reset all choices")),
        )
    }
    # Once a file was opened, the button is named by the file.
    controls["Open"] = page.locator("label", has_text="Open").locator("input")
    for name, control in controls.items():
        visit.reach(control).focus()
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
