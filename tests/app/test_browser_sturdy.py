"""What people do to a page: share it, go back, leave, come again, lose the line, break things."""

import re

import numpy as np
import pytest
from playwright.sync_api import expect

from cutcell_app.files.receive import MAX_UPLOAD
from cutcell_assets import demo_path
from tests.app.browser import Visit, changed
from tests.app.small import RESOLUTION

pytestmark = pytest.mark.slow

SAME = 0.01
"""Part of the pixels: the address rounds where the camera is, and edges may fall on other ones."""


def address(visit, has):
    """Wait until the address says something; return it."""
    code = "text => location.search.includes(text)"
    visit.page.wait_for_function(code, arg=has)
    return visit.page.url


def cut_from_aside(visit):
    """Look at a cut of the graph from aside; return the link to it."""
    visit.page.get_by_role("tab", name="Graph").click()
    visit.button("Cut Y").click()
    box = visit.page.get_by_role("application").bounding_box()
    visit.page.mouse.move(box["x"] + 200, box["y"] + 300)
    visit.page.mouse.down()
    visit.page.mouse.move(box["x"] + 320, box["y"] + 320, steps=4)
    visit.page.mouse.up()
    link = address(visit, "camera=")
    assert "panel=graph" in link
    assert "cut_axis=y" in link
    return link


def test_a_link_shows_a_colleague_the_same(browser, visit):
    link = cut_from_aside(visit)
    seen = visit.look()
    other = Visit(browser, link)
    other.wait_until_bound()
    other.dismiss()
    shown = other.look()
    assert changed(seen, shown) < SAME
    # What one person does the other does not see.
    visit.switch("Mesh edges")
    visit.go("?rig=rabbit&resolution=16")
    assert changed(shown, other.look()) == 0
    assert "cut_axis=y" in other.address
    other.close()


def test_a_refresh_brings_back_what_was_seen_and_choices_are_undone(visit):
    cut_from_aside(visit)
    seen = visit.look()
    visit.page.reload()
    visit.wait_until_bound()
    visit.dismiss()
    assert changed(seen, visit.look()) < SAME
    visit.page.mouse.click(700, 690)
    visit.button("Cut X").click()
    address(visit, "cut_axis=x")
    visit.page.mouse.click(700, 690)
    visit.page.keyboard.press("Control+z")
    address(visit, "cut_axis=y")
    visit.button("Redo").click()
    address(visit, "cut_axis=x")
    visit.button("Reset all choices").click()
    visit.page.wait_for_function("!/cut_axis|camera/.test(location.search)")


# A key that is pressed before a frame is drawn without the card: its button has the focus still.
CLOSE_AND_PLAY = """() => {
  let part = document.activeElement
  while (part.shadowRoot?.activeElement) { part = part.shadowRoot.activeElement }
  part.closest("dialog").close()
  const target = part.getRootNode().activeElement ?? document.activeElement
  const options = {key: " ", bubbles: true, composed: true, cancelable: true}
  target.dispatchEvent(new KeyboardEvent("keydown", options))
}"""


def test_keys_change_the_bone_play_and_list_themselves(visit):
    bone = visit.bone
    before = bone.inner_text()
    visit.page.mouse.click(700, 690)
    visit.page.keyboard.press("ArrowRight")
    address(visit, "bone=")
    expect(bone).not_to_have_text(before)
    visit.page.keyboard.press("?")
    card = visit.page.get_by_role("dialog", name="Controls")
    card.wait_for()
    visit.page.keyboard.press("Escape")
    card.wait_for(state="hidden")
    visit.page.keyboard.press("?")
    card.wait_for()
    visit.page.evaluate(CLOSE_AND_PLAY)
    # On a busy machine it plays for a while before the panel Pose stands there and keys are heard.
    visit.button("Pause").wait_for()
    visit.page.wait_for_function("__cutcell.report().time > 0")
    visit.page.keyboard.press("Space")
    visit.button("Play").wait_for()
    visit.page.wait_for_function("!__cutcell.report().playing")


# Attempts to find the server again follow each other at once.
CLOSE = """() => {
  const {setTimeout} = window
  window.setTimeout = (act, pause, ...rest) => setTimeout(act, pause === 2000 ? 50 : pause, ...rest)
  window.isFirst = true
  sockets.at(-1).close()
}"""


def test_a_lost_connection_is_told_tried_again_and_comes_back(visit):
    is_gone, attempts = True, []

    def head(route):
        if route.request.method == "HEAD":
            attempts.append(is_gone)
        if route.request.method == "HEAD" and is_gone:
            route.abort()
        else:
            route.continue_()

    visit.page.route(re.compile(r":\d+/$"), head)
    visit.panel("Graph")
    visit.page.evaluate(CLOSE)
    visit.expect_text(re.compile("connection to the server is lost"))
    while len(attempts) < 2:
        visit.page.wait_for_event("requestfailed")
    is_gone = False
    visit.page.wait_for_function("!window.isFirst && window.__cutcell?.messages")
    visit.wait_until_bound()
    visit.page.unroute_all()
    assert attempts.count(False) == 1
    assert "panel=graph" in visit.address
    assert f"resolution={RESOLUTION}" in visit.address
    visit.dismiss()
    visit.complaints.clear()  # the browser itself tells of the lost line


def test_a_graphics_card_that_is_reset_costs_nothing(visit):
    visit.panel("Graph")
    visit.button("Cut Y").click()
    visit.page.evaluate("__cutcell.orbit.turn(0.7, 0); __cutcell.orbit.rest()")
    visit.settle()
    before = visit.report()
    visit.page.evaluate("""() => {
      window.first = __cutcell
      window.card = first.renderer.context.getExtension("WEBGL_lose_context")
      card.loseContext()
    }""")
    visit.expect_text("graphics card was reset")
    visit.page.evaluate("card.restoreContext()")
    visit.page.wait_for_function("window.__cutcell?.messages")
    visit.settle()
    assert visit.page.evaluate("first.gone")
    after = visit.report()
    assert after["actors"] == before["actors"]
    np.testing.assert_allclose(after["camera"], before["camera"], atol=1e-6)
    assert visit.page.evaluate("__cutcell.renderer.frames") > 0
    assert not visit.page.evaluate("__cutcell.renderer.context.isContextLost()")


def test_too_large_a_file_is_refused_before_it_is_sent(visit, tmp_path):
    visit.expect_text(re.compile("up to 200 MB"))
    huge = tmp_path / "huge.glb"
    with huge.open("wb") as file:
        file.truncate(MAX_UPLOAD + 1)
    points = len(visit.points())
    visit.drop(huge)
    visit.expect_text(re.compile(r"huge\.glb.*takes files of up to 200 MB"))
    visit.dismiss()
    assert len(visit.points()) == points


def test_a_cancelled_upload_leaves_all_as_it_was(visit, tmp_path):
    big = tmp_path / "big.glb"
    with big.open("wb") as file:
        file.truncate(60 * 2**20)
    points = len(visit.points())
    visit.drop(big)
    visit.expect_text(re.compile(r"Sending big\.glb"))
    visit.page.locator("label + button", has_text="Cancel").filter(visible=True).click()
    visit.page.get_by_text("Drop a character here").wait_for()
    visit.page.wait_for_function("!document.body.innerText.includes('Sending')")
    assert len(visit.points()) == points
    visit.drop(demo_path("rabbit"))
    visit.page.wait_for_function("n => __cutcell.report().actors.body.points !== n", arg=points)
