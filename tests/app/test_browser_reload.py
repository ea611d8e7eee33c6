"""A page that is loaded again goes on where it was: strokes, selection, undo and redo."""

import pytest
from playwright.sync_api import expect

from cutcell import Edits
from tests.app.browser import IN_SIGHT

pytestmark = pytest.mark.slow


def edits(visit):
    """Return the edits that the page saves."""
    with visit.page.expect_download() as saved:
        visit.reach(visit.button("Save")).click()
    return Edits.load(saved.value.path())


def test_after_a_reload_the_keys_undo_and_redo_the_strokes_before_it(visit):
    page = visit.page

    def stroke():
        page.mouse.down()
        page.mouse.move(x + 2, y + 2)
        page.mouse.move(x, y)
        page.mouse.up()
        visit.settle()

    def press(key):
        page.keyboard.press(key)
        visit.settle()

    visit.choose("Bone", "forearm.L")
    visit.button("Select by").click()
    page.get_by_role("menuitem", name="All", exact=True).click()
    page.keyboard.press("b")
    page.wait_for_function("__cutcell.brush.part")  # its keys mean nothing before
    for _ in range(3):
        press("]")
    little = "__cutcell.renderer.actors.get('body').values[vertex] < 0.3"
    _, x, y = page.evaluate(IN_SIGHT, little)
    page.mouse.move(x, y)
    stroke()
    once = edits(visit)
    page.mouse.move(x, y)
    stroke()  # in the page's address half a second later at most
    page.reload()
    visit.wait_until_bound()
    twice = edits(visit)
    assert len(twice.layers) == 1
    assert twice != once
    visit.expect_text("40 vertices of 40 selected")
    assert "selection" in visit.report()["actors"]
    expect(page.get_by_role("switch", name="Paint", exact=True)).to_be_checked()
    page.get_by_role("application").focus()
    press("Control+z")
    assert edits(visit) == once
    page.get_by_role("application").focus()
    press("Control+z")
    expect(visit.button("Save")).to_be_disabled()
    press("Control+Shift+z")
    press("Control+Shift+z")
    assert edits(visit) == twice
    expect(visit.button("Redo")).to_be_disabled()
