"""Selections in a browser: lasso, keys, the table and the histogram."""

import re

import pytest
from playwright.sync_api import expect

pytestmark = pytest.mark.slow


def selection(visit):
    """Return the line that counts the selected vertices."""
    return visit.page.get_by_text(re.compile(r"selected\.")).filter(visible=True).first


def test_a_lasso_a_key_the_table_and_the_histogram(visit):
    page = visit.page
    box = page.get_by_role("application").bounding_box()
    x, y = box["x"] + box["width"] / 2, box["y"] + box["height"] / 2
    page.mouse.move(x, y)
    visit.bone.focus()  # a closed list takes no letters
    page.keyboard.press("s")
    visit.settle()
    page.keyboard.press("q")
    visit.settle()
    visit.unfold()
    expect(page.get_by_role("switch", name="Lasso", exact=True)).to_be_checked()

    def draw(far):
        corners = [(-far, -far), (far, -far), (far, far), (-far, far)]
        page.mouse.move(x - far, y - far)
        page.mouse.down()
        for dx, dy in corners[1:]:
            page.mouse.move(x + dx, y + dy, steps=4)
        page.mouse.up()
        visit.settle()

    draw(300)
    few = int(selection(visit).inner_text().split()[0])
    assert 0 < few < 40, "what is hidden is not selected"
    visit.switch("Lasso hidden vertices")
    visit.settle()
    draw(300)
    assert int(selection(visit).inner_text().split()[0]) > few
    visit.switch("Table")
    visit.switch("Histogram")
    visit.settle()
    page.get_by_role("button", name="Vertex").last.click()
    visit.settle()
    cell = page.get_by_role("textbox", name=re.compile("^Weight of .* at vertex")).first
    cell.fill("0.25")
    cell.press("Enter")
    visit.settle()
    expect(page.get_by_role("textbox", name=re.compile("^Weight of .* at vertex")).first
           ).to_have_value("0.250")  # fmt: skip
    bar = page.get_by_role("button", name=re.compile(r"^[\d.]+ to [\d.]+: [1-9]")).first
    bar.focus()
    bar.press("Enter")
    visit.settle()
    expect(bar).to_have_attribute("aria-pressed", "true")
    assert "selection" in visit.report()["actors"]
    page.get_by_role("application").focus()
    page.keyboard.press("Shift+A")
    visit.settle()
    page.keyboard.press("Control+z")
    visit.settle()
    for name in ("Table", "Histogram", "Lasso hidden vertices", "Lasso"):
        visit.switch(name)
