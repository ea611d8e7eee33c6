"""The flat scene in a browser: by mouse, touch and keys, in narrow windows, and with axe."""

import re

import pytest
from playwright.sync_api import expect

from cutcell_app.features.learn.lesson import built_in
from cutcell_app.widgets.modules import ADDRESS
from tests.app.browser import Visit
from tests.app.small import SMALL
from tests.app.test_browser_accessibility import faults

pytestmark = pytest.mark.slow

SHOWN = SMALL.removeprefix("/") + "&panel=graph&bone=chest&flat={}"
"""The address of a mode of the flat scene."""


def scene(visit):
    return visit.page.get_by_role("region", name=re.compile("^Flat scene"))


def canvas(visit):
    return scene(visit).get_by_role("application")


def says(visit, text):
    expect(scene(visit).locator("#say")).to_have_text(re.compile(text))


def test_a_person_goes_through_the_modes(visit):
    visit.go(SHOWN.format("rays"))
    says(visit, r"Ray \d+ of \d+\. Crossings: \+1 −1")
    first = scene(visit).locator("#say").inner_text()
    canvas(visit).focus()
    visit.page.keyboard.press("ArrowDown")
    expect(scene(visit).locator("#say")).not_to_have_text(first)
    visit.page.keyboard.press("ArrowUp")
    says(visit, re.escape(first))
    box = canvas(visit).bounding_box()
    visit.page.mouse.move(box["x"] + 0.6 * box["width"], box["y"] + 0.4 * box["height"])
    visit.page.mouse.down()
    visit.page.mouse.move(box["x"] + 0.6 * box["width"], box["y"] + 0.95 * box["height"])
    visit.page.mouse.up()
    says(visit, r"Ray 1 of")
    visit.go(SHOWN.format("winding"))
    says(visit, "pieces are inside")
    visit.slide("τ in this plane", "End")
    says(visit, r"τ = 0\.99")
    visit.go(SHOWN.format("graph"))
    canvas(visit).focus()
    visit.page.keyboard.press("Enter")
    says(visit, r"joined to 3 corners of its triangle.* Joined so far: 1\.")
    visit.button("Join all").click()
    expect(visit.button("Separate all")).to_be_visible()
    visit.go(SHOWN.format("search"))
    says(visit, r"^0 of \d+ nodes are settled, from chest\. Which node is settled next\?")
    for _ in range(3):
        visit.button("Settle next").click()
    says(visit, "^3 of")
    assert faults(visit) == []
    for name in ("Reset all choices", "Copy the link to this view"):
        visit.button(name).click(trial=True)  # nothing is over the toolbar
    visit.button("Play").click()
    says(visit, "The queue is empty")
    visit.button("Into the body").click()
    expect(scene(visit)).to_have_count(0)
    visit.page.wait_for_function("!location.search.includes('flat=')")


def test_a_step_that_is_opened_with_its_answer_shows_it(visit):
    number = next(i for i, one in enumerate(built_in(), 1) if "flat=graph" in one.address)
    visit.go(f"?step={number}&answer=&resolution=16")
    says(visit, "joined to 3 corners of its triangle")
    visit.button("Leave").click()


def test_a_phone_with_reduced_motion(browser, url):
    screen = {"viewport": {"width": 390, "height": 844}, "has_touch": True}
    visit = Visit(browser, f"{url}/{SHOWN.format('rays')}", reduced_motion="reduce", **screen)
    visit.wait_until_bound()
    box = canvas(visit).bounding_box()
    at = {"x": box["width"] / 2, "y": 4}
    canvas(visit).tap(position=at)
    says(visit, r"Ray (\d+) of \1\.")
    visit.button("Into the body").tap()
    expect(scene(visit)).to_have_count(0)
    visit.close()


SENTENCE = """async (address) => {
  const at = (name) => new URL(`${address}/${name}.js`, document.baseURI).href
  const [{sentence}, {stylesheet}] = await Promise.all(
    [at("lesson/sentence"), at("common/styles")].map((one) => import(one)))
  window.chosen = []
  const stops = Array.from({length: 101}, (_, i) => [i / 100, String(i / 100)])
  const sliders = {alpha: {value: 0.5, label: "Smoothness α", stops}}
  const {node, show} = sentence("Drag α to {alpha}, not {beta}.", sliders,
    (name, value) => chosen.push([name, value]))
  window.slid = (value) => show({alpha: {...sliders.alpha, value}})
  window.host = document.body.appendChild(document.createElement("div"))
  host.style.cssText = "position: fixed; left: 300px; top: 300px; z-index: 9999"
  host.append((await stylesheet("lesson/sentence.css"))(), node)
}"""


def test_a_number_in_a_sentence_is_dragged_and_moved_by_keys(visit):
    page = visit.page
    page.evaluate(SENTENCE, ADDRESS)
    expect(page.get_by_text("not {beta}")).to_be_visible()
    number = page.get_by_role("slider", name="Smoothness α").last
    expect(number).to_have_attribute("aria-valuetext", "0.5")
    number.focus()
    for key in ("ArrowRight", "ArrowUp", "PageDown"):
        number.press(key)
    expect(number).to_have_text("0.42")
    box = number.bounding_box()
    x, y = box["x"] + box["width"] / 2, box["y"] + box["height"] / 2
    page.mouse.move(x, y)
    page.mouse.down()
    page.mouse.move(x + 31, y)
    page.evaluate("slid(0)")  # what the server still says
    page.mouse.up()
    expect(number).to_have_text("0.52")
    page.wait_for_function("chosen.at(-1)[1] === 0.52")
    assert page.evaluate("chosen.every(([name]) => name === 'alpha')")
    page.evaluate("slid(0.07)")
    expect(number).to_have_text("0.07")
    page.evaluate("host.remove()")
