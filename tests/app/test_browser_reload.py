"""A page that is loaded again goes on where it was: strokes, selection, undo and redo."""

import pytest
from playwright.sync_api import expect

from cutcell import Edits
from tests.app.browser import IN_SIGHT

pytestmark = pytest.mark.slow


def painted(visit):
    """Return which vertices are painted, by the edits that the page saves."""
    with visit.page.expect_download() as saved:
        visit.reach(visit.button("Save")).click()
    layers = Edits.load(saved.value.path()).layers
    return {v for layer in layers for v in layer.content.vertices.tolist()}


def stroke(visit, others):
    """Paint at a vertex of little weight that is none of some others."""
    little = "__cutcell.renderer.actors.get('body').values[vertex] < 0.3"
    code = f"{little} && !{sorted(others)}.includes(vertex)"
    _, x, y = visit.page.evaluate(IN_SIGHT, code)
    visit.page.mouse.move(x, y)
    visit.page.mouse.down()
    visit.page.mouse.move(x + 2, y + 2)
    visit.page.mouse.up()
    visit.settle()


def test_after_a_reload_the_keys_undo_and_redo_the_strokes_before_it(visit):
    page = visit.page
    visit.choose("Bone", "forearm.L")
    visit.button("Select by").click()
    page.get_by_role("menuitem", name="All", exact=True).click()
    page.keyboard.press("b")
    page.wait_for_function("__cutcell.brush.part")
    for _ in range(3):
        page.keyboard.press("]")
    visit.settle()
    stroke(visit, set())
    once = painted(visit)
    stroke(visit, once)
    twice = painted(visit)
    assert twice > once
    stroke(visit, twice)
    page.reload()  # the address is not written yet
    visit.wait_until_bound()
    thrice = painted(visit)
    assert thrice > twice
    visit.expect_text("40 vertices of 40 selected")
    expect(page.get_by_role("switch", name="Paint", exact=True)).to_be_checked()
    assert "selection" in visit.report()["actors"]
    page.get_by_role("application").focus()
    page.keyboard.press("Control+z")
    visit.settle()
    assert painted(visit) == twice
    page.keyboard.press("Control+z")
    visit.settle()
    assert painted(visit) == once
    page.keyboard.press("Control+Shift+z")
    visit.settle()
    assert painted(visit) == twice
