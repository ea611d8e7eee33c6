"""The view as PyVista draws it on the server: where it rests, and without WebGL."""

import io

import numpy as np
import pytest
from PIL import Image
from playwright.sync_api import expect

from tests.app.browser import Visit, changed
from tests.app.small import SMALL

pytestmark = pytest.mark.slow

FRAME = """() => {
  const {canvas} = window.__cutcell.overlay
  return canvas.classList.contains("rendered")
}"""
BUTTON = "Rendered by PyVista, with soft shadows, when the view rests"
NO_WEBGL = """
  const {getContext} = HTMLCanvasElement.prototype
  HTMLCanvasElement.prototype.getContext = function (kind, ...rest) {
    return kind.startsWith("webgl") ? null : getContext.call(this, kind, ...rest)
  }
"""


def canvas(page):
    picture = page.get_by_role("application").screenshot()
    return np.asarray(Image.open(io.BytesIO(picture)).convert("RGB")).astype(int)


def from_afar(picture):
    """Return a picture as an eye sees it that does not see single lines."""
    height, width = (side // 8 * 8 for side in picture.shape[:2])
    return picture[:height, :width].reshape(height // 8, 8, width // 8, 8, 3).mean(axis=(1, 3))


def is_rendered(visit, rendered=True):
    """Wait until the view is, or is not, the server's picture."""
    visit.page.wait_for_function(f"rendered => ({FRAME})() === rendered", arg=rendered)


def test_the_server_draws_what_the_browser_shows_where_it_rests(visit):
    for panel in ("Graph", "Distance", "Pose", "Compare", "Check", "Weights"):
        visit.panel(panel)
        by_browser = visit.look()
        visit.button(BUTTON).click()
        visit.page.mouse.move(2, 2)
        is_rendered(visit)
        by_server = canvas(visit.page)
        if panel != "Weights":
            visit.button(BUTTON).click()
            is_rendered(visit, False)
        difference = np.abs(from_afar(by_browser) - from_afar(by_server)).max(axis=2)
        assert (difference > 48).mean() < 0.003, f"{panel}: corners are darker, no more"
        assert np.abs(from_afar(by_browser) - by_browser[5, 5]).max() > 60, panel
    box = visit.page.get_by_role("application").bounding_box()
    visit.page.mouse.move(box["x"] + 200, box["y"] + 300)
    visit.page.mouse.down()
    visit.page.mouse.move(box["x"] + 260, box["y"] + 300)
    assert not visit.page.evaluate(FRAME)
    visit.page.mouse.up()
    is_rendered(visit)
    visit.button(BUTTON).click()


def test_a_browser_without_webgl_sees_and_turns_the_character(browser, url):
    visit = Visit(browser, "about:blank")
    visit.context.add_init_script(NO_WEBGL)
    visit.page.goto(url + SMALL)
    shown = visit.page.locator(".canvas.rendered .frame")
    shown.wait_for()
    visit.status.wait_for()
    first = canvas(visit.page)
    assert len(np.unique(first.reshape(-1, 3), axis=0)) > 1000
    source = shown.get_attribute("src")
    box = visit.page.get_by_role("application").bounding_box()
    visit.page.mouse.move(box["x"] + 200, box["y"] + 200)
    visit.page.mouse.down()
    visit.page.mouse.move(box["x"] + 300, box["y"] + 200)
    visit.page.mouse.up()
    expect(shown).not_to_have_attribute("src", source)
    assert changed(first, canvas(visit.page)) > 0.02
    visit.close()
