"""No panel has a serious fault for people who use a keyboard or a screen reader."""

import pytest
from axe_playwright_python.sync_playwright import Axe

from cutcell_app.state import PANELS

pytestmark = pytest.mark.slow

SERIOUS = ("serious", "critical")


@pytest.fixture
def dark(visit):
    """Make the page dark for a while."""
    visit.button("Toggle theme").click()
    yield
    visit.button("Toggle theme").click()


def faults(visit, rules):
    """Return the serious faults, each with the elements at fault."""
    found = Axe().run(visit.page, options={"resultTypes": ["violations"], **rules})
    return [
        f"{fault['id']} ({fault['help']}): {node['target']} {node['html'][:160]} "
        f"{(node.get('any') or [{}])[0].get('message', '')}"
        for fault in found.response["violations"]
        if fault["impact"] in SERIOUS
        for node in fault["nodes"]
    ]


def lasting(visit, rules):
    """Return the faults that are still there when everything has taken its colours."""
    found = faults(visit, rules)
    for _ in range(20):
        if not found:
            break
        visit.page.wait_for_timeout(700)
        found = faults(visit, rules)
    return found


def opened(visit, panel):
    """Return the faults of each list of a panel, opened."""
    found = []
    lists = (
        visit.page.get_by_role("combobox").all() if panel in ("graph", "weights", "pose") else []
    )
    for one in lists:
        if not one.is_visible():
            continue
        name = one.inner_text()
        one.click()
        visit.page.get_by_role("menu").wait_for()
        found += [f"{panel}, {name}: {fault}" for fault in lasting(visit, {})]
        visit.page.keyboard.press("Escape")
        visit.page.get_by_role("menu").wait_for(state="hidden")
    return found


def test_no_panel_has_a_serious_fault(visit):
    check(visit, {}, opened)


def test_no_panel_has_one_in_the_dark_where_only_colours_differ(visit, dark):
    check(visit, {"runOnly": ["color-contrast"]}, lambda visit, panel: [])


def check(visit, rules, more):
    """Go through all panels; `more` returns what else is wrong on one."""
    visit.go("?rig=robot&resolution=24")
    told = []
    for panel in PANELS.values():
        if panel.needs_audit:  # of an audit: test_browser_pairs.py
            continue
        visit.page.get_by_role("tab", name=panel.title).click()
        visit.page.wait_for_function("id => location.search.includes('panel=' + id)", arg=panel.id)
        visit.settle()
        told += [f"{panel.id}: {fault}" for fault in lasting(visit, rules)]
        told += more(visit, panel.id)
    visit.page.keyboard.press("?")
    told += [f"keys: {fault}" for fault in lasting(visit, rules)]
    visit.page.keyboard.press("Escape")
    assert told == [], "\n".join(sorted(set(told)))
