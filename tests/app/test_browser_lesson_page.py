"""The lesson in one file, opened from the disk without a network."""

import re

import numpy as np
import pytest
from playwright.sync_api import expect

import cutcell
from cutcell_app.features.learn.lesson import built_in
from cutcell_app.features.opened import read_checked
from cutcell_app.headless.lesson_page import lesson_page
from cutcell_assets import demo_path
from tests.app.browser import IN_SIGHT, changed
from tests.app.test_browser_interactive import CAMERA, LOOK, Alone, scene

MAX_BYTES = 12_000_000
RABBIT = "rig=rabbit&resolution=16"
STEPS = f"""---
title: Weights
question: Does the paw move the forearm?
address: {RABBIT}&panel=weights&weights_shown=bone&bone=paw.L
answer: {{kind: choice, options: ["Yes", "No"], expected: "No"}}
reveal: panel=distance
sentence: Joints move what is below them.
---
This is the distance from the paw.
---
title: Bodies
question: Which bone moves the head?
address: {RABBIT}&panel=weights&weights_shown=mix
answer: {{kind: vertex, options: [head, hips], expected: head}}
---
A click answers.
---
title: Falloff
question: How far is it?
address: {RABBIT}&panel=weights&weights_shown=bone&bone=chest&falloff=paper&alpha=0
answer: {{kind: number, expected: 2, tolerance: 1, unit: m}}
offers: {{Animation: falloff=rig}}
---
α is {{alpha}}.
---
title: Inside
question: Where is the sum 1?
address: {RABBIT}&panel=graph&bone=chest&flat=rays
answer: {{kind: act, options: ["0", "1"], expected: "1"}}
reveal: flat=winding
---
From {{winding_threshold}} on, a point is inside.
---
title: Paint
question: What does the arm move?
address: {RABBIT}&panel=pose&bone=upper_arm.L&pose_colors=plain
answer: {{kind: paint, joint: upper_arm.L, expected: 0.01, button: Lift}}
reveal: turns=14:0,0,40
---
It moves all below it.
"""


@pytest.fixture(scope="module")
def path(tmp_path_factory):
    folder = tmp_path_factory.mktemp("lesson")
    (folder / "steps.md").write_text(STEPS, encoding="utf-8")
    path = folder / "lesson.html"
    path.write_text(lesson_page(read_checked(folder / "steps.md")), encoding="utf-8")
    return path


class Lesson(Alone):
    """A lesson in one file."""

    def resize(self, width, height):
        """Give the canvas a size, in pixels; the card is beside it."""
        for _ in range(2):
            canvas = self.page.get_by_role("application").bounding_box()
            size = self.page.viewport_size
            more = width - round(canvas["width"]), height - round(canvas["height"])
            size = {"width": size["width"] + more[0], "height": size["height"] + more[1]}
            self.page.set_viewport_size(size)
            self.settle()


def opened(browser, path):
    alone = Lesson(browser, path.as_uri())
    alone.context.set_offline(True)
    alone.settle()
    return alone


def test_a_lesson_is_walked_without_a_server(browser, visit, path):
    alone = opened(browser, path)
    card = alone.page.get_by_role("article", name="Lesson")
    expect(card).to_contain_text("Does the paw move the forearm?")
    weights = f"?{RABBIT}&panel=weights&weights_shown=bone&bone=paw.L"
    check_same_picture(visit, alone, weights)
    asked = alone.look()
    card.get_by_role("button", name="No", exact=True).click()
    expect(card).to_contain_text("Right: No.")
    alone.settle()
    assert changed(asked, alone.look()) > 0.01
    check_same_picture(visit, alone, f"?{RABBIT}&panel=distance&bone=paw.L")

    card.get_by_role("button", name="Next").click()
    assert alone.page.url.endswith("#step-2")
    _, x, y = alone.page.evaluate(IN_SIGHT, "true")
    alone.page.mouse.click(x, y)
    expect(card).to_contain_text(re.compile("Right|You chose"))

    alone.page.evaluate("location.hash = '#step-3'")
    card.get_by_role("spinbutton").fill("2.5")
    card.get_by_role("button", name="Answer").click()
    expect(card).to_contain_text("α is 0.")
    alone.settle()
    before = alone.look()
    card.get_by_role("button", name="Animation").click()
    alone.settle()
    animation = alone.look()
    assert changed(before, animation) > 0.01
    slider = card.get_by_role("slider", name="Smoothness α")
    slider.press("ArrowRight")
    expect(slider).to_have_text("0.25")
    expect(card.get_by_role("button", name="Animation")).to_have_attribute("aria-pressed", "false")
    alone.settle()
    assert changed(animation, alone.look()) > 0.01

    check_flat_step(alone, card)
    card.get_by_role("button", name="Next").focus()
    alone.page.keyboard.press("PageDown")
    expect(card).to_contain_text("What does the arm move?")
    alone.settle()
    plain = alone.look()
    x, y = alone.page.evaluate("__cutcell.bonePoint(14)")
    alone.page.mouse.move(x, y)
    alone.page.mouse.down()
    alone.page.mouse.move(x + 20, y + 20, steps=4)
    alone.page.mouse.up()
    alone.settle()
    assert changed(plain, alone.look()) > 5e-3, "more than the ring of the brush"
    card.get_by_role("button", name="Lift").click()
    expect(card).to_contain_text("agrees to")
    alone.page.emulate_media(media="print")
    rows = alone.page.locator(".handout li")
    expect(rows).to_have_count(5)
    expect(rows.first).to_contain_text("Joints move what is below them.")
    assert rows.first.locator("img").evaluate("image => image.naturalWidth") > 100
    alone.check()
    alone.close()


def check_flat_step(alone, card):
    """See that the flat scene takes an answer, and shows every threshold of the slider."""
    card.get_by_role("button", name="Next").click()
    expect(card).to_contain_text("Where is the sum 1?")
    alone.page.get_by_role("region", name="Flat scene: Rays").get_by_text("This point").click()
    expect(card).to_contain_text(re.compile("Right: 1|You chose"))
    flat = alone.page.get_by_role("region", name="Flat scene: Winding numbers")
    card.get_by_role("slider", name="Winding threshold").press("ArrowRight")
    expect(card).to_contain_text("From 0.51 on")
    expect(flat.get_by_role("slider", name="τ in this plane")).to_have_value("0.51")
    flat.get_by_role("button", name="Into the body").click()
    expect(flat).to_be_hidden()


def check_same_picture(visit, alone, address):
    """See that the page shows the same scene from the same camera."""
    visit.go(address)
    canvas = visit.page.get_by_role("application").bounding_box()
    alone.resize(round(canvas["width"]), round(canvas["height"]))
    alone.page.evaluate(LOOK, visit.page.evaluate(CAMERA))
    served = scene(visit)
    difference = np.abs(scene(alone) - served).max(axis=2)
    assert np.abs(served - served[-1, 0]).max() > 100, "something is seen"
    assert (difference > 24).mean() < 3e-3


def check_two_sliders(alone, card):
    """See that a number in the text leaves the other as it is."""
    neighbours = card.get_by_role("slider", name="Connectivity")
    resolution = card.get_by_role("slider", name="Resolution R")
    expect(resolution).to_have_text("128")
    neighbours.press("End")
    expect(neighbours).to_have_text("any angle")
    alone.settle()
    resolution.press("Home")
    expect(resolution).to_have_text("20")
    alone.settle()
    expect(neighbours).to_have_text("any angle")
    expect(
        card.get_by_role("img", name="mean error in %, against any angle at R = 192 over R")
    ).to_be_visible()


@pytest.mark.nightly
def test_the_built_in_lesson_is_walked_to_its_end(browser, tmp_path):
    path = tmp_path / "lesson.html"
    path.write_text(lesson_page(), encoding="utf-8")
    assert path.stat().st_size < MAX_BYTES
    alone = opened(browser, path)
    card = alone.page.get_by_role("article", name="Lesson")
    for number, step in enumerate(built_in().steps, 1):
        expect(card).to_contain_text(step.question)
        assert alone.page.url.endswith(f"#step-{number}")
        assert alone.report()["actors"]["body"]["visible"]
        if step.answer.kind == "vertex":
            alone.settle()
            body = len(cutcell.load(demo_path("biped")).mesh.vertices)  # the cape comes after it
            _, x, y = alone.page.evaluate(IN_SIGHT, f"vertex >= {body}")
            alone.page.mouse.click(x, y)
            expect(card).to_contain_text(f"Right: {step.answer.expected[0]}.")
        else:
            card.get_by_role("button", name="Show me").click()
        expect(card).to_contain_text(step.sentence)
        if {"resolution", "connectivity"} <= set(step.named):
            check_two_sliders(alone, card)
        for label in step.offers:
            card.get_by_role("button", name=label, exact=True).click()
            alone.settle()
        alone.check()
        card.get_by_role("button", name=re.compile("Next|Done")).click()
        alone.settle()
    alone.close()
