"""No panel has a fault for people who use a keyboard or a screen reader."""

import re
from urllib.parse import parse_qs

import pytest
from axe_playwright_python.sync_playwright import Axe
from playwright.sync_api import expect

from cutcell_app.features.state import PANELS

pytestmark = pytest.mark.slow

OVER = "region"
"""The rule that menus and dialogs break: MUI draws them outside of all landmarks."""

TITLES = [panel.title for panel in PANELS.values() if not panel.needs_audit]
"""Of the panels; that of an audit is in test_browser_pairs.py."""

OF_PANEL = re.compile("^(?!Character|Bone)")
"""Names of menus, but for the two that stand on every panel."""

LAYER = "[data-pmui-layer]"
"""What menus and tooltips are drawn in; it goes with them."""

# Brings all that fades to its end, in all shadow roots: half of a colour is no fault.
FADED = """async () => {
  for (;;) {
    const roots = [document]
    for (const root of roots) {
      for (const one of root.querySelectorAll("*")) {
        if (one.shadowRoot) { roots.push(one.shadowRoot) }
      }
    }
    const all = [...new Set(roots.flatMap((root) => root.getAnimations()))].filter(
      ({effect, playState}) => playState !== "finished"
        && effect.getComputedTiming().endTime < Infinity)
    if (!all.length) { return }
    all.forEach((one) => one.finish())
    await new Promise(requestAnimationFrame)
  }
}"""


def faults(visit, besides=None, **rules):
    """Return all faults, each with the elements at fault, once nothing fades any more."""
    visit.page.evaluate(FADED)
    result = Axe().run(visit.page, options={"resultTypes": ["violations"], **rules})
    return [
        f"{fault['id']} ({fault['help']}): {node['target']} {node['html'][:160]} "
        f"{(node.get('any') or [{}])[0].get('message', '')}"
        for fault in result.response["violations"]
        if fault["id"] != besides
        for node in fault["nodes"]
    ]


def faults_of_menus(visit, names):
    """Return the faults of each menu of some names that is seen, opened."""
    result = []
    for one in visit.page.get_by_role("combobox", name=names).all():
        if not one.is_visible():
            continue
        name = one.get_attribute("aria-labelledby") or one.inner_text()
        one.click()
        visit.page.get_by_role("menu").wait_for()
        result += [f"menu {name}: {fault}" for fault in faults(visit, besides=OVER)]
        visit.page.keyboard.press("Escape")
        visit.page.get_by_role("menu").wait_for(state="hidden")
    return result


def choose(visit, title):
    """Choose a panel, with its sections as they are."""
    visit.page.get_by_role("tab", name=title).click()
    visit.settle()
    expect(visit.page.locator(LAYER)).to_have_count(0)  # of a menu or a tooltip that is leaving


@pytest.mark.parametrize("title", TITLES)
def test_a_panel_has_no_fault(visit, title):
    choose(visit, title)
    assert faults(visit) == []


@pytest.mark.parametrize(
    ("title", "names"), [("Graph", re.compile("")), ("Weights", OF_PANEL), ("Pose", OF_PANEL)]
)
def test_menus_have_no_fault(visit, title, names):
    choose(visit, title)
    assert faults_of_menus(visit, names) == []


FOCUSED = "item => item === item.getRootNode().activeElement"


def take_by_keys(visit, menu, name):
    """Open a menu and take an item by keys alone; return the faults of the open menu."""
    keyboard, items = visit.page.keyboard, visit.page.get_by_role("menuitem")
    visit.reach(visit.button(menu)).focus()
    keyboard.press("Enter")
    item = items.get_by_text(name, exact=True)
    item.wait_for()
    reports = [f"menu {menu}: {fault}" for fault in faults(visit, besides=OVER)]
    for _ in range(items.count()):
        if items.filter(has_text=name).first.evaluate(FOCUSED):
            break
        keyboard.press("ArrowDown")
    keyboard.press("Enter")
    expect(visit.page.get_by_role("menu")).to_have_count(0)
    visit.settle()
    visit.unfold()
    return reports


def test_masks_of_layers_need_no_mouse_and_have_no_fault(visit):
    choose(visit, "Weights")
    reports = take_by_keys(visit, "Select by", "All")
    reports += take_by_keys(visit, "Add layer", "From file")
    before = parse_qs(visit.address[1:])["edits"]
    reports += take_by_keys(visit, "Mask", "Invert")
    assert parse_qs(visit.address[1:])["edits"] != before
    reports += faults(visit)
    visit.page.keyboard.press("Control+z")
    assert parse_qs(visit.address[1:])["edits"] == before
    visit.page.set_viewport_size({"width": 390, "height": 844})
    visit.settle()
    reports += [f"narrow: {fault}" for fault in faults(visit)]
    visit.page.set_viewport_size({"width": 1100, "height": 720})
    assert reports == []


def test_the_list_of_keys_has_no_fault(visit):
    visit.page.keyboard.press("?")
    assert faults(visit, besides=OVER) == []
    visit.page.keyboard.press("Escape")


def test_contrasts_are_as_good_in_the_dark(visit):
    """All else is as in the light."""
    assert visit.look()[2, 2].min() > 200
    visit.button("Toggle theme").click()
    reports = []
    for title in TITLES:
        choose(visit, title)
        reports += [f"{title}: {fault}" for fault in faults(visit, runOnly=["color-contrast"])]
    assert visit.look()[2, 2].max() < 80
    visit.button("Toggle theme").click()
    assert reports == []
