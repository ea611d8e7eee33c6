"""No panel has a fault for people who use a keyboard or a screen reader."""

import pytest
from axe_playwright_python.sync_playwright import Axe
from playwright.sync_api import expect

from cutcell_app.features.state import PANELS

pytestmark = pytest.mark.slow

OVER = "region"
"""The rule that menus and dialogs break: MUI draws them outside of all landmarks."""

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


def in_both_themes(visit):
    """Return the faults in the light, and in the dark, where only colours differ."""
    expect(visit.page.locator(LAYER)).to_have_count(0)  # of a menu or a tooltip that is leaving
    result = faults(visit)
    visit.button("Toggle theme").click()
    visit.settle()
    result += [f"dark: {fault}" for fault in faults(visit, runOnly=["color-contrast"])]
    visit.button("Toggle theme").click()
    visit.settle()
    return result


def in_menus(visit, seen):
    """Return the faults of each menu of a panel, opened, unless it was seen before."""
    result = []
    for one in visit.page.get_by_role("combobox").all():
        name = one.get_attribute("aria-labelledby") or one.inner_text()
        if not one.is_visible() or name in seen:
            continue
        seen.add(name)
        one.click()
        visit.page.get_by_role("menu").wait_for()
        result += [f"menu {name}: {fault}" for fault in faults(visit, besides=OVER)]
        visit.page.keyboard.press("Escape")
        visit.page.get_by_role("menu").wait_for(state="hidden")
    return result


def test_no_panel_has_a_fault(visit):
    reports, menus = [], set()
    for name, panel in PANELS.items():
        if panel.needs_audit:  # of an audit: test_browser_pairs.py
            continue
        visit.page.get_by_role("tab", name=panel.title).click()
        visit.settle()
        reports += [f"{name}: {fault}" for fault in in_both_themes(visit)]
        if name in ("graph", "weights", "pose"):
            reports += in_menus(visit, menus)
    visit.page.keyboard.press("?")
    reports += [f"keys: {fault}" for fault in faults(visit, besides=OVER)]
    visit.page.keyboard.press("Escape")
    assert reports == [], "\n".join(sorted(set(reports)))
