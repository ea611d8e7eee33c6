"""The page in a browser, used as a person uses it."""

import re

import numpy as np
import pytest
from playwright.sync_api import expect

import cutcell
from cutcell.pose import axis_rotation
from cutcell_viewers.character import pose_in_scene, to_scene
from cutcell_viewers.pose_scene import joint_turns
from tests.app.browser import changed
from tests.app.small import FINE, RESOLUTION
from tests.viewers.arm import arm_rig

pytestmark = pytest.mark.slow

TWO_FRAMES = "new Promise((next) => requestAnimationFrame(() => requestAnimationFrame(next)))"
LAYERS = {"Surface": "body"} | {f"{kind} edges": None for kind in ("Mesh", "Interior", "Surface")}


def test_every_layer_can_be_switched(visit):
    visit.panel("Graph")
    before = visit.look()
    for name, actor in LAYERS.items():
        for is_seen in (False, True):
            visit.switch(name)
            visit.settle()
            assert visit.report()["actors"][actor or name.lower()]["visible"] == is_seen
    visit.switch("Interior edges")
    assert changed(before, visit.look()) > 0.002
    visit.switch("Interior edges")
    assert changed(before, visit.look()) < 0.001


def test_the_cutting_plane_moves_through_the_body(visit):
    visit.go(FINE)
    visit.panel("Graph")
    visit.button("Whole").click()
    whole = visit.look()
    visit.button("Cut X").click()
    half = visit.look()
    assert changed(whole, half) > 0.01
    visit.button("Half").click()
    thick = visit.look()
    assert changed(half, thick) > 0.0005
    visit.slide("Position", "PageDown", 3)
    less = visit.look()
    assert changed(thick, less) > 0.001
    thick = less
    visit.switch("Interior edges")
    assert changed(thick, visit.look()) > 0.001
    visit.switch("Interior edges")
    visit.button("Whole").click()
    assert changed(whole, visit.look()) < 0.001


def test_a_bone_is_picked_by_clicking_it(visit, small):
    names = small.skeleton.names
    chosen = visit.bone
    other = next(
        j
        for j in range(len(names))
        if names[j] != chosen.inner_text() and len(small.skeleton.children[j])
    )
    before = visit.look()
    visit.click_bone(other)
    # Bones may cover each other: one that passes there is chosen, and shown as chosen.
    legend = visit.page.get_by_text(re.compile("^Weight of "))
    picked = legend.inner_text().removeprefix("Weight of ")
    assert picked in names
    expect(chosen).to_have_text(picked)
    assert changed(before, visit.look()) > 0.01
    weights = visit.look()
    visit.panel("Distance")
    visit.expect_text(f"Distance from {picked}")
    assert changed(weights, visit.look()) > 0.01
    visit.choose("Bone", names[0])
    visit.expect_text(f"Distance from {names[0]}")


def test_dragging_turns_the_character_and_picks_nothing(visit):
    before = visit.look()
    box = visit.page.get_by_role("application").bounding_box()
    x, y = box["x"] + box["width"] / 2, box["y"] + box["height"] / 2
    visit.page.mouse.move(x, y)
    visit.page.mouse.down()
    visit.page.mouse.move(x + 120, y + 30, steps=6)
    visit.page.mouse.up()
    turned = visit.look()
    assert changed(before, turned) > 0.02
    visit.page.mouse.move(x, y)
    visit.page.mouse.wheel(0, -400)
    assert changed(turned, visit.look()) > 0.02
    visit.page.mouse.dblclick(box["x"] + 20, box["y"] + 20)
    assert changed(before, visit.look()) < 0.002
    assert visit.page.get_by_text(re.compile("^Weight of ")).count() == 0
    canvas = visit.page.get_by_role("application")
    canvas.blur()
    canvas.focus()
    visit.page.keyboard.press("ArrowLeft")
    assert changed(before, visit.look()) > 0.01


def test_an_impossible_resolution_is_told_and_the_page_lives_on(visit):
    visit.panel("Graph")
    box = visit.page.get_by_role("textbox")
    slider = visit.page.get_by_role("slider", name="Resolution")
    box.fill("10000")
    box.press("Enter")
    visit.expect_text(re.compile("resolution must be .* not 10000;", re.IGNORECASE))
    visit.dismiss()
    visit.settle()
    expect(box).to_have_value(str(RESOLUTION))
    expect(slider).to_have_attribute("max", "160")


def test_a_joint_is_turned_as_the_core_turns_it(visit, small):
    visit.panel("Pose")
    rest = visit.points()
    np.testing.assert_allclose(rest, to_scene(small, small.mesh.vertices), atol=1e-5)
    before = visit.look()
    visit.slide("About Z", "ArrowRight", 25)
    after = visit.look()
    assert changed(before, after) > 0.002
    joint = small.skeleton.names.index(visit.bone.inner_text())
    weights = cutcell.bind(small, RESOLUTION).weights
    transforms = cutcell.forward_kinematics(
        small.skeleton, joint_turns(small, {joint: axis_rotation("z", 25)})
    )
    scene = pose_in_scene(small, transforms)
    expected = cutcell.linear_blend_skinning(rest, weights, scene)
    np.testing.assert_allclose(visit.points(), expected, atol=1e-4)
    visit.button("Rest pose").click()
    visit.settle()
    np.testing.assert_allclose(visit.points(), rest, atol=1e-6)


HAS_MOVED = """(before) => __cutcell.renderer.actors.get("body").posed()
  .some((place, at) => Math.abs(place - before[at]) > 0.02)"""


def play(visit):
    """Let the motion run until the body has moved from where it is now."""
    before = visit.points().ravel().tolist()
    visit.page.get_by_role("button", name="Play", exact=True).click()
    visit.page.wait_for_function(HAS_MOVED, arg=before)


def test_the_motion_plays_and_halts(visit):
    visit.panel("Pose")
    rest = visit.points()
    play(visit)
    visit.page.get_by_role("button", name="Pause", exact=True).click()
    visit.page.wait_for_function("!__cutcell.report().playing")
    visit.settle()
    halted = visit.points()
    posed = visit.report()["posed"]
    visit.page.evaluate(TWO_FRAMES)
    assert visit.report()["posed"] == posed
    np.testing.assert_array_equal(visit.points(), halted)
    visit.choose("Motion", "Swing the bone")
    play(visit)
    visit.button("Rest pose").click()
    visit.page.wait_for_function("!__cutcell.report().playing")
    visit.settle()
    np.testing.assert_allclose(visit.points(), rest, atol=1e-6)


# What a model is told in quick succession, as a server may tell it; what it says by itself.
TOLD_QUICKLY = """async () => {
  const models = [...Bokeh.documents[0]._all_models.values()]
  const {data} = models.find(({data}) => String(data?.attributes?.object).includes(" vertices ·"))
  const channel = new MessageChannel()
  const pauses = [
    () => new Promise((done) => setTimeout(done)),
    () => new Promise(requestAnimationFrame),
    () => new Promise((done) => { channel.port1.onmessage = done; channel.port2.postMessage(0) }),
  ]
  const before = data.object
  const strange = []
  let text = before
  data.properties.object.change.connect(() => {
    if (data.object !== text) { strange.push([text, data.object]) }
  })
  for (let round = 0; round < 300; round++) {
    text = round === 299 ? before : `round ${round}`
    data.setv({object: text}, {sync: false})
    await pauses[round % 3]()
  }
  // What the component would say by itself comes with a frame, or when it has nothing else to do.
  await new Promise((done) => requestAnimationFrame(() => requestIdleCallback(done)))
  return strange
}"""


def test_a_component_does_not_tell_back_what_it_was_told(visit):
    assert visit.page.evaluate(TOLD_QUICKLY) == []


def test_a_character_that_was_opened_stays_within_reach(visit, tmp_path):
    mine = tmp_path / "mine.glb"
    cutcell.save(mine, arm_rig())
    visit.open(mine)
    points = visit.report()["actors"]["body"]["points"]
    visit.choose("Character", "Small")
    stands = "n => (__cutcell.report().actors.body.points === n)"
    visit.page.wait_for_function(f"n => !({stands})(n)", arg=points)
    visit.wait_until_bound()
    visit.page.go_back()
    visit.page.wait_for_function(stands, arg=points)
    visit.wait_until_bound()
    visit.button("Undo").click()
    visit.page.wait_for_function(f"n => !({stands})(n)", arg=points)
    visit.wait_until_bound()
    visit.choose("Character", "mine.glb")
    visit.page.wait_for_function(stands, arg=points)
    visit.wait_until_bound()


def test_another_character_is_seen_from_as_far_as_it_needs_in_the_graph(visit, tmp_path):
    size = visit.page.viewport_size
    visit.page.set_viewport_size({"width": 1440, "height": 900})  # no card is near the character
    visit.go("?rig=robot&panel=graph&resolution=24")
    cutcell.save(tmp_path / "arm.glb", arm_rig())
    visit.open(tmp_path / "arm.glb")
    needed = visit.page.evaluate("__cutcell.insets.fit(__cutcell.renderer.insets)")
    assert visit.page.evaluate("__cutcell.orbit.distance") == pytest.approx(needed, rel=0.04)
    visit.page.set_viewport_size(size)


def test_a_long_computation_can_be_cancelled(visit):
    visit.panel("Graph")
    box = visit.page.get_by_role("textbox")
    box.fill("512")  # some seconds of work, even for a small character
    box.press("Enter")
    visit.click_when_seen("Cancel")
    visit.expect_text("Cancelled. Nothing was changed.")
    visit.dismiss()
    visit.wait_until_bound()
    expect(box).to_have_value(str(RESOLUTION))


def test_a_file_can_be_dropped_on_the_canvas(visit, tmp_path):
    points = len(visit.points())
    cutcell.save(tmp_path / "arm.glb", arm_rig())
    content = list((tmp_path / "arm.glb").read_bytes())
    visit.page.get_by_role("application").evaluate(
        """(canvas, content) => {
          const files = new DataTransfer()
          files.items.add(new File([new Uint8Array(content)], "dropped.glb"))
          for (const type of ["dragenter", "dragover", "drop"]) {
            const options = {dataTransfer: files, bubbles: true, cancelable: true}
            canvas.dispatchEvent(new DragEvent(type, options))
          }
        }""",
        content,
    )
    visit.page.wait_for_function("n => __cutcell.report().actors.body.points !== n", arg=points)
    visit.wait_until_bound()
    visit.expect_text("dropped")
