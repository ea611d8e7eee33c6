"""The panel Pose in a browser: rings, ghosts, errors in colours, motions, films."""

import re

import numpy as np
import pytest
from PIL import Image
from playwright.sync_api import expect

import cutcell
from cutcell.pose import axis_rotation
from cutcell_viewers.character import pose_in_scene
from cutcell_viewers.pose_scene import joint_turns
from tests.app.browser import SCALE, changed
from tests.app.small import RESOLUTION
from tests.app.test_browser_accessibility import faults
from tests.viewers.textures import png, seen, squares, wall

pytestmark = pytest.mark.slow

TWO_FRAMES = "new Promise((drawn) => requestAnimationFrame(() => requestAnimationFrame(drawn)))"


@pytest.fixture
def visit(visit):
    """Show the figure at rest on the panel Pose."""
    visit.panel("Pose")
    return visit


def drag_ring(visit, axis, dx, dy):
    x, y = visit.page.evaluate("axis => __cutcell.gizmo.handle(axis)", axis)
    visit.page.mouse.move(x, y)
    visit.page.mouse.down()
    visit.page.mouse.move(x + dx, y + dy, steps=6)
    visit.page.evaluate(TWO_FRAMES)  # the last move is handled with the next frame
    local = visit.points()
    reports = visit.page.locator(".angle")
    expect(reports).to_contain_text(f"{'XYZ'[axis]} ")
    degrees = reports.inner_text().split()[1].rstrip("°")
    visit.page.mouse.up()
    expect(slider(visit, "XYZ"[axis])).to_have_value(degrees)
    visit.settle()
    return local


def slider(visit, axis):
    return visit.page.get_by_role("slider", name=f"About {axis}")


def angle(visit, axis):
    return float(slider(visit, axis).input_value())


def pose_of(visit, small):
    """Return the pose of the chosen bone that the slider about z turns."""
    joint = small.skeleton.names.index(visit.bone.inner_text())
    turns = joint_turns(small, {joint: axis_rotation("z", angle(visit, "Z"))})
    return pose_in_scene(small, cutcell.forward_kinematics(small.skeleton, turns))


def rest(visit):
    visit.settle()
    button = visit.button("Rest pose")
    if button.is_enabled():
        button.click()
    expect(button).to_be_disabled()
    visit.settle()


def test_a_ring_turns_the_joint_and_the_server_agrees(visit, small):
    still = visit.points()
    before = visit.look()
    local = drag_ring(visit, 2, -50, 50)
    assert np.abs(local - still).max() > 0.01
    np.testing.assert_allclose(visit.points(), local, atol=2e-3 * np.ptp(local))
    assert changed(before, visit.look()) > 0.005
    degrees = angle(visit, "Z")
    assert abs(degrees) > 10
    assert angle(visit, "X") == angle(visit, "Y") == 0
    weights = cutcell.bind(small, RESOLUTION).weights
    expected = cutcell.linear_blend_skinning(still, weights, pose_of(visit, small))
    np.testing.assert_allclose(visit.points(), expected, atol=1e-4 * np.ptp(still))
    rest(visit)
    np.testing.assert_array_equal(visit.points(), still)


def test_a_finger_turns_a_ring_too(visit):
    x, y = visit.page.evaluate("__cutcell.gizmo.handle(2)")
    touch = visit.context.new_cdp_session(visit.page)
    for kind, at in (("touchStart", (x, y)), ("touchMove", (x - 30, y + 40)), ("touchEnd", None)):
        points = [] if at is None else [{"x": at[0], "y": at[1]}]
        touch.send("Input.dispatchTouchEvent", {"type": kind, "touchPoints": points})
    visit.settle()
    assert abs(angle(visit, "Z")) > 5
    rest(visit)


@pytest.mark.parametrize("blending", ["Linear", "Dual quaternions"])
def test_what_the_card_draws_is_where_the_points_are(visit, small, blending):
    plain, still = visit.look(), visit.points()
    visit.slide("About Z", "PageUp", 4)
    visit.settle()
    pose, binding = pose_of(visit, small), cutcell.bind(small, RESOLUTION)
    linear = cutcell.linear_blend_skinning(still, binding.weights, pose)
    dual = cutcell.dual_quaternion_skinning(still, binding.weights, pose)
    assert np.abs(linear - dual).max() > 1e-3 * np.ptp(still)
    visit.button(blending).click()
    visit.settle()
    expected = linear if blending == "Linear" else dual
    np.testing.assert_allclose(visit.points(), expected, atol=1e-4 * np.ptp(still))
    turned = visit.look()
    visit.page.evaluate("""() => {
      const {renderer} = __cutcell
      const actors = [...renderer.actors.values()].filter((actor) => actor.skin)
      window.__rests = actors.map((actor) => [actor, actor.rest])
      const moved = actors.map((actor) => actor.posed())
      renderer.setPose(null)
      actors.forEach((actor, i) => actor.setPoints(moved[i]))
      __cutcell.changed()
    }""")
    same = visit.look()
    far = (np.abs(turned - same).max(axis=2) > 80).mean()  # normals and rings differ a little
    assert changed(plain, turned) > 0.01
    assert far < 0.004, far
    visit.page.evaluate("""() => {
      for (const [actor, rest] of window.__rests) { actor.setPoints(rest) }
      __cutcell.applyPose()
    }""")
    visit.button("Linear").click()
    rest(visit)


def test_the_worst_turns_are_a_click_away(visit):
    rows = visit.page.get_by_role("list", name="Largest errors").get_by_role("button")
    rows.first.wait_for()
    before = visit.look()
    name = rows.first.locator("span").inner_text()
    rows.first.click()
    visit.expect_text("Error against the file's weights")
    bone, axis = re.fullmatch(r"(.*) about ([XYZ])", name).groups()
    expect(visit.bone).to_have_text(bone)
    visit.settle()
    assert angle(visit, axis) == 30
    expect(rows.first).to_have_attribute("aria-current", "true")
    visit.expect_text(re.compile(r"RMS [\d.e-]+ mm in this pose"))
    coloured = visit.look()
    assert changed(before, coloured) > 0.01
    black = (coloured.max(axis=2) < 25).mean()  # no value is without a colour, nor any place
    assert black < 0.002
    visit.switch("Error as colours")
    assert changed(coloured, visit.look()) > 0.0005


def test_the_files_weights_are_a_ghost_or_a_neighbour(visit):
    visit.page.get_by_role("list", name="Largest errors").get_by_role("button").first.click()
    visit.expect_text(re.compile(r"RMS [\d.e-]+ mm in this pose"))
    alone, camera = visit.look(), visit.report()["camera"]
    visit.button("Ghost").click()
    ghost = visit.look()
    assert changed(alone, ghost) > 0.0002
    visit.button("Side by side").click()
    visit.expect_text("Weights from the file")
    beside = visit.look()
    assert changed(ghost, beside) > 0.02
    half = beside.shape[1] // 2
    for side in (beside[60:, : half - 2], beside[60:, half + 2 :]):
        assert np.ptp(side.reshape(-1, 3), axis=0).max() > 100  # somebody stands on either side
    visit.button("Alone").click()
    visit.page.wait_for_function("__cutcell.renderer.views.length < 2")
    visit.settle()
    np.testing.assert_allclose(visit.report()["camera"], camera, rtol=0.05)  # framed anew


def test_a_motion_runs_halts_and_is_moved_through(visit):
    rest(visit)
    still = visit.points()
    visit.button("Play").click()
    visit.page.wait_for_function("__cutcell.report().time > 0.1")
    visit.button("Pause the motion").click()
    visit.page.wait_for_function("!__cutcell.report().playing")
    track = visit.page.get_by_role("slider", name="Time in the motion")
    track.focus()
    track.press("Home")
    visit.settle()
    first = visit.points()
    for _ in range(3):
        track.press("PageUp")
    visit.settle()
    assert np.abs(visit.points() - first).max() > 1e-3
    assert visit.page.locator(".gizmo").is_hidden()
    visit.button("Speed: 1 times", exact=False).click()
    visit.button("Speed: 2 times", exact=False).wait_for()
    rest(visit)
    np.testing.assert_array_equal(visit.points(), still)
    assert visit.page.locator(".transport").is_hidden()


def test_poses_are_saved_shown_and_filmed_by_keys(visit, tmp_path):
    page, rows = visit.page, visit.page.get_by_role("list", name="Poses and clips")
    expect(rows.get_by_role("button")).to_have_count(1)
    assert re.fullmatch(r"Wave\s*[\d.]+ → [\d.]+", rows.inner_text())
    visit.slide("About Z", "PageUp", 4)
    visit.settle()
    bent = visit.points()
    box = page.get_by_role("textbox", name="Save pose as")
    box.fill("bent")
    box.press("Enter")
    expect(rows.get_by_role("button")).to_have_count(2)
    visit.settle()
    rest(visit)
    wave, pose = (rows.get_by_role("button", name=name) for name in ("Wave", "bent"))
    wave.press("Enter")
    expect(wave).to_have_attribute("aria-current", "true")
    visit.settle()
    assert visit.report()["time"] > 0, "the clip stands where it stretches most"
    assert not visit.report()["playing"]
    pose.press("Enter")
    expect(pose).to_have_attribute("aria-current", "true")
    visit.settle()
    np.testing.assert_allclose(visit.points(), bent, atol=1e-6)
    visit.slide("About X", "PageUp", 4)
    visit.settle()
    box.fill("twisted")
    box.press("Enter")
    expect(rows.get_by_role("button")).to_have_count(3)
    pose.press("Enter")
    visit.settle()
    np.testing.assert_allclose(visit.points(), bent, atol=1e-6, err_msg="it was not saved over")
    visit.button("Worst vertex").press("Enter")
    expect(page.get_by_role("button", name="Why these weights?")).to_be_visible()
    page.keyboard.press("Escape")
    assert faults(visit) == []
    box = page.get_by_role("textbox", name="Rename pose")
    box.fill("elbow")
    box.press("Enter")
    expect(rows.get_by_role("button", name="elbow")).to_be_visible()
    visit.choose("Motion", "Saved poses")
    visit.button("Side by side").click()
    visit.button("Image, video").click()
    with page.expect_download() as download:
        page.get_by_role("menuitem", name="Motion (GIF)").click()
    download.value.save_as(tmp_path / "film.gif")
    with Image.open(tmp_path / "film.gif") as film:
        assert film.n_frames > 20
    visit.button("Delete pose").press("Enter")
    expect(rows.get_by_role("button")).to_have_count(2)


def test_a_film_and_the_numbers_come_out(visit, tmp_path):
    for menu, item, start in (
        ("Image, video", "Picture (PNG)", b"\x89PNG"),
        ("Image, video", "Motion (MP4)", b"ftyp"),
        ("Data", "Weights (CSV)", b"\nvertex,"),
    ):
        visit.button(menu).click()
        with visit.page.expect_download() as download:
            visit.page.get_by_role("menuitem", name=item).click()
        path = tmp_path / download.value.suggested_filename
        download.value.save_as(path)
        assert start in path.read_bytes()[:4000]


def test_the_files_materials_are_seen_as_it_moves(visit, tmp_path):
    visit.open(wall(png(squares())).save(tmp_path / "wall.glb"))
    coloured = visit.look()
    visit.button("Materials").click()
    assert changed(coloured, visit.look()) > 0.1
    assert visit.page.locator(".legend").is_hidden()
    for turned in (False, True):
        if turned:
            visit.slide("About Z", "PageUp", 2)
        pixels = visit.look()
        corners = visit.points()[:4]
        for near, (u, v) in enumerate([(0.1, 0.1), (0.9, 0.1), (0.9, 0.9), (0.1, 0.9)]):
            share = np.full(4, 0.1)
            share[near], share[near - 2] = 0.8, 0
            point = (share @ corners).tolist()
            x, y, _ = visit.page.evaluate("at => __cutcell.renderer.project(at)", point)
            result, expected = pixels[round(y * SCALE), round(x * SCALE)], seen(u, v).astype(int)
            np.testing.assert_array_equal(
                result > 0.6 * result.max(), expected > 0.6 * expected.max(), f"{near} {turned}"
            )
    visit.button("Plain").click()
    grey = visit.look()
    assert changed(pixels, grey) > 0.1
    visit.button("Materials").click()
    assert changed(pixels, visit.look()) < 0.01


def test_what_is_behind_shines_through_blended_materials(visit, tmp_path):
    look = {"alphaMode": "BLEND", "pbr": {"baseColorFactor": [1, 1, 1, 0.5]}}
    visit.open(wall(png(squares()), **look).save(tmp_path / "glass.glb"))
    visit.button("Materials").click()
    pixels = visit.look()
    middle = visit.points()[[0, 2]].mean(axis=0).tolist()
    x, y, _ = visit.page.evaluate("at => __cutcell.renderer.project(at)", middle)
    x, y = round(x * SCALE), round(y * SCALE)
    part = pixels[y - 30 : y - 10, x - 30 : x - 10]
    red = part[..., 0] - part[..., 1] > 60
    assert abs(red.mean() - 0.5) < 0.1
