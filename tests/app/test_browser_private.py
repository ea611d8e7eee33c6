"""What the scripts know of the widget library's DOM is still there."""

import pytest

from cutcell_app.widgets.modules import ADDRESS

pytestmark = pytest.mark.slow

MISSING = """async ([address, names]) => {
  const {PARTS} = await import(new URL(address, document.baseURI).href)
  const has = (root, selector) => root.querySelector(selector)
    || [...root.querySelectorAll("*")]
      .some((one) => one.shadowRoot && has(one.shadowRoot, selector))
  return names.filter((name) => !has(document, PARTS[name])).map((name) => [name, PARTS[name]])
}"""
EVERYWHERE = ("field", "adornment", "number", "checkbox", "select", "resizer", "title")
IN_MENU = ("list", "search", "item", "chosen")
NARROW = ("sheet", "layer")
"""In a narrow window: test_browser_welcome.py."""


def check(visit, names):
    """Check that the page has some parts."""
    missing = visit.page.evaluate(MISSING, [f"{ADDRESS}/page/mui.js", names])
    sentences = [f"panel-material-ui has no {name} as {part}: see mui.js" for name, part in missing]
    assert not sentences, "\n".join(sentences)


def test_parts_of_the_widget_library_are_where_scripts_look(visit):
    visit.panel("Graph")
    check(visit, EVERYWHERE)
    visit.bone.click()
    visit.page.get_by_role("menu").wait_for()
    check(visit, IN_MENU)
    visit.page.keyboard.press("Escape")
    visit.page.get_by_role("menu").wait_for(state="hidden")
