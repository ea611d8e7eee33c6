"""The panel Compare in a browser."""

import re

import numpy as np
import pytest
from playwright.sync_api import expect

from cutcell_assets import demo_path
from tests.app.browser import changed
from tests.conftest import SHARED_RIGS

pytestmark = pytest.mark.slow

REAL = SHARED_RIGS / "webxr_hand_right.glb"
SOURCE = REAL if REAL.exists() else demo_path("rabbit")


def test_methods_of_a_real_character_are_compared(visit):
    visit.open(SOURCE)
    visit.panel("Compare")
    a_bone_is_picked_in_any_view(visit)
    methods_stand_side_by_side_with_their_measures(visit)
    one_camera_turns_all(visit)
    differences_errors_and_poses_are_seen(visit)


def test_what_is_seen_in_a_comparison_is_mended(visit):
    visit.open(SOURCE)
    visit.panel("Compare")
    box(visit, "cutcell (animation)").uncheck()
    box(visit, "Current weights").check()
    visit.settle()  # of two methods none can be removed
    box(visit, "Euclidean").uncheck()
    visit.button("Computed").click()
    visit.settle()
    the_largest_disagreement_is_mended(visit)
    settings_are_swept_and_a_point_is_chosen(visit)


def box(visit, name):
    return visit.page.get_by_role("checkbox", name=name)


def captions(visit):
    return visit.page.locator(".caption").all_inner_texts()


def measured(visit, name):
    cells = visit.page.get_by_role("row").filter(has_text=name).get_by_role("cell")
    expect(cells.nth(3)).not_to_have_text("")
    return [float(text) for text in cells.all_inner_texts()[1:]]


def methods_stand_side_by_side_with_their_measures(visit):
    l1, deformation, seconds = measured(visit, "Euclidean")
    assert 0 < l1 < 2
    assert deformation > 0
    assert seconds >= 0
    visit.settle()
    assert captions(visit) == ["From file", "cutcell (animation)", "Euclidean"]
    box(visit, "cutcell (animation)").uncheck()
    box(visit, "Current weights").check()
    measured(visit, "Current weights")
    visit.settle()
    assert captions(visit) == ["Current weights", "From file", "Euclidean"]
    three = visit.look()
    box(visit, "Voxel binding, UniRig's").check()
    measured(visit, "UniRig")
    visit.settle()
    assert len(captions(visit)) == 4
    assert changed(three, visit.look()) > 0.02
    expect(box(visit, "Bone heat")).to_be_disabled()
    box(visit, "Voxel binding, UniRig's").uncheck()
    visit.settle()
    box(visit, "Euclidean").uncheck()
    visit.settle()
    assert captions(visit) == ["Current weights", "From file"]
    expect(box(visit, "From file")).to_be_disabled()


def one_camera_turns_all(visit):
    before = visit.look()
    half = before.shape[1] // 2
    place = visit.page.get_by_role("application").bounding_box()
    x, y = place["x"] + place["width"] * 0.75, place["y"] + place["height"] / 2
    visit.page.mouse.move(x, y)
    visit.page.mouse.down()
    visit.page.mouse.move(x + 60, y, steps=4)
    visit.page.mouse.up()
    after = visit.look()
    for side in (slice(0, half), slice(half, None)):
        assert changed(before[:, side], after[:, side]) > 0.02


def differences_errors_and_poses_are_seen(visit):
    plain = visit.look()
    visit.choose("Difference to", "From file")
    visit.expect_text("difference")
    difference = visit.look()
    assert changed(plain, difference) > 0.005
    assert captions(visit)[0] == "Current weights − From file"
    visit.button("Error").click()
    visit.expect_text("Largest error for 30° turns")
    assert changed(difference, visit.look()) > 0.005
    still = visit.points("body 1")
    visit.button("Play").click()
    visit.page.wait_for_function("__cutcell.report().time > 0.3")
    visit.button("Pause").click()
    visit.page.wait_for_function("!__cutcell.report().playing")
    assert np.abs(visit.points("body 1") - still).max() > 1e-3 * np.ptp(still)
    visit.button("Rest pose").click()
    visit.settle()
    np.testing.assert_array_equal(visit.points("body 1"), still)


def a_bone_is_picked_in_any_view(visit):
    expect(visit.bone).not_to_have_text("")
    chosen = visit.bone.inner_text()
    ends = visit.page.evaluate("""() => {
      const {bones, renderer, overlay} = __cutcell
      const box = overlay.canvas.getBoundingClientRect()
      return bones.names.map((name, joint) => {
        const i = bones.joint.indexOf(joint)
        const start = renderer.project(bones.start.slice(3 * i, 3 * i + 3), 1)
        const end = renderer.project(bones.end.slice(3 * i, 3 * i + 3), 1)
        return [name, box.left + (start[0] + end[0]) / 2, box.top + (start[1] + end[1]) / 2]
      })
    }""")
    other = max(
        (end for end in ends if end[0] != chosen),
        key=lambda end: min(
            np.hypot(end[1] - x, end[2] - y) for name, x, y in ends if name != end[0]
        ),
    )
    visit.page.mouse.click(other[1], other[2])
    visit.expect_text(f"Weight of {other[0]}")


def the_largest_disagreement_is_mended(visit):
    before = measured(visit, "Current weights")[1]
    rest = visit.points("body")
    region = visit.page.get_by_text("of the error", exact=False).first
    visit.reach(region)
    visit.page.locator(".MuiAccordion-root", has=region).get_by_role("button").nth(1).click()
    visit.settle()
    assert np.abs(visit.points("body") - rest).max() > 1e-3 * np.ptp(rest), "it is posed"
    assert any(name.startswith("region") for name in visit.report()["actors"])
    visit.page.get_by_role("button", name="Take this").press("Enter")
    visit.settle()
    expect(visit.page.get_by_role("button", name="Take this")).to_have_count(0)
    assert measured(visit, "Current weights")[1] < before


def settings_are_swept_and_a_point_is_chosen(visit):
    page = visit.page
    page.context.grant_permissions(["clipboard-read", "clipboard-write"])
    values = visit.reach(page.get_by_label("Values", exact=True))
    values.fill("8,12,1")
    values.press("Enter")
    page.get_by_role("button", name="Compute", exact=True).click()
    expect(page.get_by_text("Resolution must be a whole number")).to_be_visible()
    visit.settle()
    point = page.get_by_role("button", name=re.compile(r"^12: 0\.\d+"))
    point.hover()
    expect(page.locator("figcaption .value")).to_have_text(re.compile("^12: 0"))
    point.press("Enter")
    expect(page.get_by_role("radio", name="12", exact=True)).to_be_checked()
    page.get_by_role("radio", name="8", exact=True).check()
    visit.settle()
    visit.reach(page.get_by_role("button", name="Code")).click()
    page.get_by_role("menuitem", name="Copy as command").click()
    expect(page.get_by_text("Command copied")).to_be_visible()
    line = page.evaluate("navigator.clipboard.readText()")
    assert line.startswith("cutcell bind")
    assert line.endswith(".layers.json"), "a region was mended"
    visit.expect_text("which was downloaded")
