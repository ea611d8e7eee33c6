"""The lesson in a browser: walked by keys, presented, and links that another person opens."""

import re
from urllib.parse import parse_qs

import pytest
from playwright.sync_api import expect

from cutcell_app.features.learn.lesson import built_in
from tests.app.browser import Visit
from tests.app.test_browser_accessibility import faults

pytestmark = pytest.mark.slow

LESSON = built_in()
SHOWN = "?step={}&resolution=16"
READY = {"rays": "Crossings", "graph": "Corners", "search": "queue holds"}
"""What each mode of the flat scene says when it can be answered."""
CARD_PART = """([card, canvas]) => {
  const [a, b] = [card, canvas].map((one) => one.getBoundingClientRect())
  return a.width * a.height / (b.width * b.height)
}"""
FOCUS_INSIDE = """() => {
  let part = document.activeElement
  while (part?.shadowRoot?.activeElement) { part = part.shadowRoot.activeElement }
  return part.closest("header, nav") === null
}"""


def card(visit):
    return visit.page.get_by_role("article", name="Lesson")


def letters(part):
    """Return the size of a part's letters in pixels."""
    return float(part.evaluate("one => getComputedStyle(one).fontSize").removesuffix("px"))


def step(visit, number):
    """Wait for a step of the lesson."""
    visit.page.wait_for_function(f"new URLSearchParams(location.search).get('step') == {number}")
    expect(card(visit)).to_contain_text(LESSON[number - 1].title)
    visit.settle()  # else a key may reach the controls of the step before


def answered(visit):
    visit.page.wait_for_function("new URLSearchParams(location.search).has('answer')")


def act(visit, mode, expected):
    """Answer in the flat scene by keys, once it shows this step and not the one before."""
    flat = visit.page.get_by_role("region", name=re.compile("^Flat scene"))
    expect(flat.locator("#say")).to_have_text(re.compile(READY[mode]))
    if "corner" in expected:
        for name in ("Corner A", "Corner B", "Corner C", "Tie"):
            visit.button(name).press("Enter")
    else:
        canvas = visit.page.get_by_role("application", name=re.compile("Rays|Search"))
        canvas.press("ArrowRight")
        canvas.press("Enter")


@pytest.fixture
def visit(visit):
    """Let a test change the size of the window."""
    size = visit.page.viewport_size
    yield visit
    visit.page.set_viewport_size(size)


def test_the_lesson_is_walked_by_keys_with_answers(visit):
    page = visit.page
    page.set_viewport_size({"width": 1440, "height": 900})
    visit.go(SHOWN.format(1))
    expect(card(visit)).to_contain_text(LESSON[0].question)
    page.wait_for_function("__cutcell.brush.part")
    page.get_by_role("application").focus()
    page.keyboard.press("Enter")  # paints at the cross
    visit.button("Lift").press("Enter")
    answered(visit)
    expect(card(visit)).to_contain_text(re.compile(r"agrees to \d+%"))
    expect(card(visit)).to_contain_text(LESSON[0].sentence)
    page.wait_for_function("__cutcell.renderer.views.length === 2")
    canvas = page.get_by_role("application").element_handle()
    for number in range(2, len(LESSON) + 1):
        page.keyboard.press("PageDown")
        step(visit, number)
        answer = LESSON[number - 1].answer
        if answer.kind == "number":
            box = card(visit).get_by_role("spinbutton")
            box.fill("0.6")
            box.press("Enter")
        elif answer.kind == "choice":
            card(visit).get_by_role("button", name=answer.expected, exact=True).press("Enter")
        elif "flat=" in LESSON[number - 1].address:
            (mode,) = parse_qs(LESSON[number - 1].address)["flat"]
            act(visit, mode, answer.expected)
        else:
            page.keyboard.press("PageDown")
        answered(visit)
        expect(card(visit)).to_contain_text(LESSON[number - 1].sentence)
        assert page.evaluate(CARD_PART, [card(visit).element_handle(), canvas]) < 1 / 3
    expect(card(visit)).to_contain_text(re.compile(r"of \d+ right"))
    assert faults(visit) == []
    page.go_back()
    step(visit, len(LESSON) - 1)
    answered(visit)
    page.keyboard.press("PageUp")
    step(visit, len(LESSON) - 2)
    visit.button("Leave").click()
    expect(card(visit)).to_be_hidden()


@pytest.mark.nightly
@pytest.mark.parametrize(
    ("width", "height", "theme"),
    [(820, 1180, "dark"), (390, 844, "light"), (844, 390, "dark")],
)
def test_each_step_has_room_and_no_fault(browser, url, width, height, theme):
    size = {"viewport": {"width": width, "height": height}, "color_scheme": theme}
    visit = Visit(browser, url + SHOWN.format(1), has_touch=True, is_mobile=True, **size)
    visit.wait_until_bound()
    reports = []
    for number, one in enumerate(LESSON, 1):
        visit.go(SHOWN.format(number))
        step(visit, number)
        reports += [f"{number}: {fault}" for fault in faults(visit)]
        way = one.answer.expected if one.answer.kind == "choice" else "Show me"
        card(visit).get_by_role("button", name=way, exact=True).tap()
        answered(visit)
        expect(card(visit)).to_contain_text(one.sentence)
        reports += [f"{number} answered: {fault}" for fault in faults(visit)]
        box = card(visit).bounding_box()
        assert box["x"] >= 0
        assert box["y"] >= 0
        assert box["x"] + box["width"] <= width
        assert box["y"] + box["height"] <= height
        assert visit.page.evaluate("document.documentElement.scrollWidth") <= width
    assert reports == []
    visit.close()


def test_a_presentation_has_one_caption_and_its_keys_only_walk(visit):
    page = visit.page
    page.set_viewport_size({"width": 1280, "height": 720})
    visit.go(SHOWN.format(4))
    page.keyboard.press("f")
    caption = card(visit).locator(".question")
    expect(card(visit)).to_have_class(re.compile("staged"))
    assert 24 <= letters(caption) <= 32
    assert letters(page.locator(".legend")) >= 16
    expect(page.get_by_role("toolbar")).to_be_hidden()
    box = page.locator(".viewport").bounding_box()
    assert (box["x"], box["y"], box["width"]) == (0, 0, 1280)
    page.keyboard.press("Tab")
    assert page.evaluate(FOCUS_INSIDE)
    page.evaluate("document.activeElement.blur()")
    for key, black in (("b", True), (".", False)):  # as a remote asks for
        page.keyboard.press(key)
        expect(page.locator(".black")).to_be_visible(visible=black)
    assert page.evaluate("!__cutcell.brush.part")
    assert faults(visit) == []
    with page.expect_popup() as opened:
        page.keyboard.press("n")
    notes = opened.value
    expect(notes.get_by_role("region", name="Notes")).to_contain_text(LESSON[3].title)
    page.keyboard.press("PageDown")
    answered(visit)
    expect(card(visit).locator(".sentence")).to_be_visible()
    page.keyboard.press("ArrowRight")
    step(visit, 5)
    expect(notes.get_by_role("region", name="Notes")).to_contain_text(LESSON[4].title)
    notes.get_by_role("button", name="Back").click()
    step(visit, 4)
    assert "stage=1" in page.url
    page.keyboard.press("Escape")
    expect(card(visit)).not_to_have_class(re.compile("staged"))
    expect(page.get_by_role("combobox", name="Bone", exact=True)).to_have_text("chest")
    notes.close()
