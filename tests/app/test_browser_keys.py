"""The sidebar by keys alone: each control is reached, and each menu opens, chooses and closes."""

import pytest
from playwright.sync_api import expect

from tests.app.test_browser_accessibility import TITLES

pytestmark = pytest.mark.slow

ACTIVE = """
  let active = document.activeElement
  while (active?.shadowRoot?.activeElement) { active = active.shadowRoot.activeElement }
"""
MARK = f"""(first) => {{ {ACTIVE}
  if (first && active.localName !== "body") {{ window.firstStop = active }}
  const again = !first && active === window.firstStop
  active.dataset.reached = ""
  return again
}}"""
ROLE = f"() => {{ {ACTIVE} return active.getAttribute('role') || active.localName }}"
IS_SEARCH = f"() => {{ {ACTIVE} return active.matches('.MuiMenu-list input') }}"

# Visible controls of the sidebar, of which a group with a roving focus counts as one.
MISSED = """() => {
  const roots = [document], missed = []
  for (let root; root = roots.pop();) {
    for (const one of root.querySelectorAll("*")) {
      if (one.shadowRoot) { roots.push(one.shadowRoot) }
    }
    const wanted = "button, input, textarea, [role=combobox], [role=tab], [role=tree]"
    const roving = "[role=tablist], [role=tree], [role=listbox], .MuiToggleButtonGroup-root"
    for (const one of root.querySelectorAll(wanted)) {
      const group = one.closest(roving)
      const reached = "reached" in one.dataset || group?.querySelector("[data-reached]")
        || group && "reached" in group.dataset
      const off = one.disabled || one.closest("[aria-disabled=true], [aria-hidden=true], [inert]")
        || one.type === "file" || one.matches("[type=hidden]")
      const box = one.getBoundingClientRect()
      const hidden = !one.checkVisibility({visibilityProperty: true}) || !box.width || !box.height
      let in_sidebar = false
      for (let at = one; at; at = at.parentNode ?? at.host) {
        in_sidebar ||= at.matches?.("nav, .sidebar, .MuiDrawer-root")
      }
      const spins = one.closest(".MuiInputAdornment-root")  // the arrow keys of the box do the same
      if (in_sidebar && !reached && !off && !hidden && !spins) {
        missed.push(`${one.localName} ${one.innerText} ${one.getAttribute("aria-label")}`)
      }
    }
  }
  return missed
}"""
CLEAR = """() => {
  const roots = [document]
  for (let root; root = roots.pop();) {
    for (const one of root.querySelectorAll("*")) {
      delete one.dataset?.reached
      if (one.shadowRoot) { roots.push(one.shadowRoot) }
    }
  }
  delete window.firstStop
  document.activeElement?.blur()
}"""
KEYS = ("Enter", " ", "ArrowDown", "ArrowUp")
MAX_STOPS = 500


def walk(visit):
    """Go through the page by Tab, once around; return the names of the menus on the way."""
    keyboard, menus = visit.page.keyboard, []
    visit.page.evaluate(CLEAR)
    for stop in range(MAX_STOPS):
        keyboard.press("Tab")
        if visit.page.evaluate(MARK, stop == 0):
            break
        if visit.page.evaluate(ROLE) == "combobox":
            check_menu(visit, KEYS[len(menus) % len(KEYS)])
            menus.append(visit.page.evaluate(f"() => {{ {ACTIVE} return active.innerText }}"))
    return menus


def check_menu(visit, key):
    """Open the menu that has the focus by a key, and close it again."""
    menu = visit.page.get_by_role("menu")
    visit.page.keyboard.press(key)
    expect(menu).to_be_visible()
    if menu.get_by_role("textbox").count():
        visit.page.wait_for_function(IS_SEARCH)
        visit.page.keyboard.press("ArrowDown")
    visit.page.wait_for_function(f"() => ({ROLE})() === 'menuitem'")
    visit.page.keyboard.press("Escape")
    # Until the menu is gone, and not only its entries, it holds the focus.
    expect(visit.page.locator(".MuiPopover-root")).to_have_count(0)
    visit.page.wait_for_function(f"() => ({ROLE})() === 'combobox'")


@pytest.mark.parametrize("title", TITLES)
def test_every_control_is_reached_and_every_menu_opens_by_keys(visit, title):
    visit.panel(title)
    assert len(walk(visit)) >= 2, "the menus of the character and of the bone"
    assert visit.page.evaluate(MISSED) == []


def test_a_joint_is_searched_for_and_chosen_by_keys(visit):
    keyboard, menu = visit.page.keyboard, visit.page.get_by_role("menu")
    before = visit.bone.inner_text()
    visit.bone.focus()
    keyboard.press("Enter")
    visit.page.wait_for_function(IS_SEARCH)
    close = menu.get_by_role("button", name="Clear search and close")
    expect(close).to_be_visible()
    names = [text for text in menu.get_by_role("menuitem").all_inner_texts() if text.strip()]
    wanted = next(name for name in names if name != before and "hand" in name.lower())
    keyboard.type(wanted)
    keyboard.press("Enter")
    expect(menu).to_have_count(0)
    expect(visit.bone).to_have_text(wanted)
    visit.page.wait_for_function(f"() => ({ROLE})() === 'combobox'")
    visit.settle()
    keyboard.press("ArrowDown")
    visit.page.wait_for_function(IS_SEARCH)
    keyboard.type("no such joint")
    keyboard.press("Enter")
    expect(menu).to_be_visible()
    keyboard.press("Escape")
    expect(menu).to_have_count(0)
    expect(visit.bone).to_have_text(wanted)


def test_controls_work_by_keys(visit):
    page = visit.page
    page.get_by_role("tab", name="Weights", exact=True).focus()
    page.keyboard.press("ArrowRight")
    page.keyboard.press("Enter")
    assert "panel=" in visit.address
    visit.panel("Weights")
    visit.slide("Max influences", "ArrowLeft")
    assert "max_influences" in visit.address
    mine = page.get_by_role("button", name="From file").first
    mine.focus()
    mine.press("Enter")
    visit.settle()
    expect(mine).to_have_attribute("aria-pressed", "true")
    data = visit.button("Data")
    data.focus()
    data.press("Enter")
    page.wait_for_function(f"() => ({ROLE})() === 'menuitem'")
    with page.expect_download() as download:
        page.keyboard.press("Enter")
    assert download.value.suggested_filename.endswith("-weights.csv")
