"""Joints, parts and vertices corrected in a browser, as a person does."""

import re

import numpy as np
import pytest
from playwright.sync_api import expect

import cutcell
from cutcell import Computed, Edits, JointEdit, Layer, Locked
from tests.app.browser import IN_SIGHT, changed
from tests.app.small import RESOLUTION
from tests.app.test_browser_accessibility import faults
from tests.cutcell.cli.files import write_obj
from tests.cutcell.diagnosis.test_leaks import soldier

SOLDIER = 24
"""Resolution at which the soldier's parts are told apart."""

pytestmark = pytest.mark.slow


# As when the paths that explain the weights have come while a person types.
SHOW_CARD_AGAIN = """() => {
  const card = [...Bokeh.documents[0].all_models].find((model) => model.facts)
  card.facts = {...card.facts}
}"""


def corrected(visit):
    """Return the edits that the page saves."""
    with visit.page.expect_download() as saved:
        visit.button("Save").click()
    return Edits.load(saved.value.path())


def exported(visit, tmp_path):
    """Return the character that the page exports."""
    with visit.page.expect_download() as saved:
        visit.button("Export GLB").click()
    path = tmp_path / "bound.glb"
    saved.value.save_as(path)
    return cutcell.load(path)


def come_again(visit):
    """Come back to the address that the page has now, from the one that it began with."""
    link = visit.address
    visit.go(visit.first[0])
    visit.go(link)
    if visit.button("Close").is_visible():
        visit.dismiss()


def test_a_doubtful_joint_has_a_switch(visit, tmp_path):
    joints = [
        {"name": name, "position": [x, 0.1, 0.1], "parent": parent}
        for name, x, parent in (("hip", 0.1, None), ("knee", 0.5, "hip"), ("prop", 0.8, "knee"))
    ]
    path = write_obj(tmp_path / "leg.obj", joints=joints)
    visit.open(path, path.with_suffix(".json"))
    listed = visit.page.get_by_role("group", name="Doubtful joints")
    switch = listed.get_by_role("switch", name="prop deforms the mesh")
    expect(switch).to_be_checked()
    expect(listed).to_contain_text("control or bone, by its name")
    visit.settle()
    share = float(listed.locator(".item .share").inner_text())
    assert 0 < share < 100, "its part of the skin, in %"
    switch.click()
    expect(switch).not_to_be_checked()
    assert corrected(visit).joints == {"prop": JointEdit(deform=False)}


def test_joints_are_corrected_by_keys_kept_and_exported(visit, small, tmp_path):
    tree = visit.page.get_by_role("tree", name="Joints")
    hips = tree.get_by_role("treeitem", name=re.compile("^hips"))
    visit.choose("Bone", "hips")
    expect(hips).to_have_attribute("aria-selected", "true")
    hips.focus()
    for key in ("ArrowLeft", "ArrowRight", "End", "Enter"):  # close, open, to the last one
        visit.page.keyboard.press(key)
    last = tree.get_by_role("treeitem").last
    expect(last).to_be_focused()
    name = small.skeleton.names[-1]
    expect(visit.bone).to_have_text(name)
    visit.page.keyboard.press(" ")
    expect(last).to_have_attribute("aria-checked", "false")
    visit.switch("Lock to file weights")
    visit.slide("Reach", "ArrowRight", 5)
    visit.settle()
    assert faults(visit) == []
    held = corrected(visit)
    assert held.joints == {name: JointEdit(deform=False)}
    assert held.reach.gain == {name: pytest.approx(2**0.5, abs=1e-3)}
    assert held.layers[1:] == (Layer(Locked([name])),)

    come_again(visit)
    assert corrected(visit) == held
    weights = exported(visit, tmp_path).weights
    fresh = cutcell.bind(small, RESOLUTION, edits=held)
    np.testing.assert_allclose(weights, fresh.weights, atol=1 / 255)
    path = tmp_path / "mine.json"
    Edits(layers=[Layer(Computed(gain={small.skeleton.names[0]: 2}))]).save(path)
    with visit.page.expect_file_chooser() as chooser:
        visit.page.locator("label", has_text="Open").click()
    chooser.value.set_files(path)
    expect(tree.get_by_text("×2")).to_be_visible()
    visit.settle()
    assert corrected(visit).layers == Edits.load(path).layers


def test_a_joint_is_dragged_and_typed_and_stays_so_in_the_file(visit, small, tmp_path):
    joint = small.skeleton.names.index("forearm.L")
    visit.choose("Bone", "forearm.L")
    visit.switch("Show move handle")
    visit.settle()
    before = visit.look()
    x, y = visit.page.evaluate("__cutcell.jointHandle()")
    visit.page.mouse.move(x, y)
    visit.page.mouse.down()
    for step in (8, 16, 24):
        visit.page.mouse.move(x + step, y - 2 * step)
    visit.settle()
    bones = visit.page.evaluate(f"__cutcell.bonePoint({joint})")
    visit.page.mouse.up()
    visit.settle()
    assert visit.page.evaluate(f"__cutcell.bonePoint({joint})") != bones, "clicked where it is"
    assert changed(before, visit.look()) > 0.002
    held = corrected(visit)
    assert list(held.joints) == ["forearm.L", "forearm.R"], "the other side moves along"
    moved = exported(visit, tmp_path)
    own = small.skeleton.joints
    for name, one in held.joints.items():
        k = small.skeleton.names.index(name)
        assert moved.skeleton.joints[k] == pytest.approx(one.position, abs=1e-5)
        assert np.linalg.norm(moved.skeleton.joints[k] - own[k]) > 0.01
    fresh = cutcell.bind(small.with_joints(moved.skeleton.joints), RESOLUTION)
    np.testing.assert_allclose(moved.weights, fresh.weights, atol=1e-3)

    field = visit.page.get_by_role("textbox", name="Y", exact=True)
    field.fill("nonsense")
    field.press("Enter")
    visit.expect_text("Y must be a number")
    visit.button("Close").click()
    field.fill("0.95")
    field.press("Enter")
    visit.settle()
    assert corrected(visit).joints["forearm.L"].position[1] == 0.95


def test_a_part_is_glued_to_a_joint(visit, small, tmp_path):
    rows = visit.page.get_by_role("list", name="Parts of the mesh")
    whole = visit.look()
    ring = rows.get_by_role("button").nth(1)
    ring.focus()
    visit.page.keyboard.press("Enter")
    expect(ring).to_have_attribute("aria-current", "true")
    assert changed(whole, visit.look()) > 0.02
    visit.choose("Bind this part", "Rigid, to one joint")
    expect(ring).to_contain_text("rigid: ")
    visit.settle()
    (layer,) = corrected(visit).layers
    ((joint, weight),) = layer.content.weights.items()
    weights = exported(visit, tmp_path).weights
    assert weights[layer.mask.part, small.skeleton.names.index(joint)] == weight == 1
    visit.button("Undo").click()
    visit.settle()
    visit.expect_text("No edits yet")


def test_a_vertex_is_overruled_on_its_card_and_undone(visit, small):
    vertex = visit.click_vertex()
    visit.card.get_by_role("button", name="Why these weights?").click()
    numbers = visit.card.get_by_role("spinbutton")
    expect(numbers.nth(1)).to_be_visible()
    for place, number in enumerate(numbers.all()):
        number.fill({0: "0.", 1: "0.6"}.get(place, "0"))
    numbers.first.press("End")
    visit.page.evaluate(SHOW_CARD_AGAIN)
    visit.page.keyboard.type("2")
    expect(numbers.first).to_have_value("0.2")
    visit.page.keyboard.press("Enter")
    expect(visit.card).to_contain_text("Weights, set manually")
    visit.settle()
    expect(numbers.first).to_have_value("0.25")  # scaled to a sum of one, though it has the focus
    expect(visit.card.locator("details").first).to_contain_text("Painted0.75")
    assert faults(visit) == []
    (layer,) = corrected(visit).layers
    assert vertex in layer.content.vertices
    np.testing.assert_allclose(np.sort(layer.content.rows.toarray()[0]), [0.25, 0.75])
    visit.button("Undo").click()
    expect(visit.card).not_to_contain_text("set manually")
    visit.button("Redo").click()
    visit.card.get_by_role("button", name="Reset").click()
    expect(visit.card).not_to_contain_text("set manually")
    visit.card.get_by_role("button", name="Hide why").click()
    visit.close_card()
    visit.expect_text("No edits yet")


def test_the_card_of_a_vertex_scrolls_within_a_small_window(visit):
    size = visit.page.viewport_size
    visit.page.set_viewport_size({"width": 1366, "height": 600})
    visit.click_vertex()
    visit.card.get_by_role("button", name="Why these weights?").click()
    expect(visit.card).to_contain_text("shares by distance")  # the card is not built again then
    override = visit.card.get_by_role("button", name="Override")
    override.scroll_into_view_if_needed()
    box = override.bounding_box()
    assert box["y"] + box["height"] <= 600
    canvas = visit.page.get_by_role("application").bounding_box()
    assert canvas["y"] > 0, "the page itself has not scrolled"
    visit.card.get_by_role("button", name="Hide why").click()
    visit.close_card()
    visit.page.set_viewport_size(size)


def test_weights_are_painted_on_a_posed_body_and_stay_so(visit, small, tmp_path):
    above = small.skeleton.names.index("upper_arm.L")
    shared = np.flatnonzero(cutcell.bind(small, RESOLUTION).weights[:, above] > 0.4).tolist()
    visit.choose("Bone", "forearm.L")
    visit.panel("Pose")
    rest = visit.points()
    visit.slide("About Z", "PageUp", 3)
    visit.page.keyboard.press("b")
    visit.page.wait_for_function("__cutcell.brush.part")  # its keys mean nothing before
    for _ in range(3):
        visit.page.keyboard.press("]")
    visit.settle()
    assert np.abs(visit.points() - rest).max() > 0.05
    posed = visit.points()
    vertex, x, y = visit.page.evaluate(IN_SIGHT, f"{shared}.includes(vertex)")
    weight = f"__cutcell.renderer.actors.get('body').values[{vertex}]"
    before = visit.page.evaluate(weight)
    visit.page.mouse.move(x, y)
    visit.page.mouse.down()
    visit.page.mouse.move(x + 4, y + 3)
    visit.settle()
    during = visit.page.evaluate(weight)
    assert during > before + 0.1, "colours follow the stroke"
    assert np.abs(visit.points() - posed).max() > 1e-3, "and so does the posed body"
    camera = visit.report()["camera"]
    visit.page.mouse.up()
    visit.settle()
    assert visit.page.evaluate(weight) == pytest.approx(during, abs=1e-3)
    assert visit.report()["camera"] == camera

    visit.panel("Weights")
    held = corrected(visit)
    assert vertex in held.layers[0].content.vertices
    assert not held.joints
    visit.button("Undo").click()
    visit.settle()
    visit.panel("Weights")  # undo goes where the stroke was made
    visit.expect_text("No edits yet")
    assert visit.page.evaluate(weight) == before
    visit.button("Redo").click()
    visit.settle()
    assert corrected(visit) == held
    paints = visit.page.get_by_role("switch", name="Paint", exact=True)
    expect(paints).to_be_checked()
    visit.button("Select").click()
    visit.page.mouse.move(x, y)
    visit.page.mouse.down()
    visit.page.mouse.up()
    visit.expect_text("Strokes are limited to")
    assert visit.page.evaluate("__cutcell.renderer.actors.has('selection')")
    visit.button("Select by").click()
    visit.page.get_by_role("menuitem", name="None", exact=True).click()
    visit.page.wait_for_function("!__cutcell.renderer.actors.has('selection')")
    visit.page.keyboard.press("Escape")
    expect(paints).not_to_be_checked()

    come_again(visit)
    assert corrected(visit) == held
    weights = exported(visit, tmp_path).weights
    fresh = cutcell.bind(small, RESOLUTION, edits=held)
    np.testing.assert_allclose(weights, fresh.weights, atol=1 / 255)


def test_the_soldier_is_mended_in_two_clicks_and_stays_so(visit, tmp_path):
    visit.go(f"?rig=small&resolution={SOLDIER}&graph_resolution=0")
    rig = soldier()
    root = len(rig.skeleton.joints) - 1
    torn = cutcell.bind(rig, SOLDIER).weights[:, root]
    path = tmp_path / "soldier.glb"
    cutcell.save(path, rig)
    visit.open(path)
    visit.button("Computed").click()
    visit.panel("Check")
    # The card tells of a vertex of the trousers what the file says, and what ours would be.
    vertex = visit.click_vertex(f"{np.flatnonzero(torn > 0.5).tolist()}.includes(vertex)")
    visit.card.get_by_role("button", name="Why these weights?").click()
    answer = visit.card.locator("details").first
    expect(answer.locator("summary")).to_contain_text("Root")
    expect(answer).to_contain_text("in the file")
    visit.close_card()

    visit.button("Stray weights").click()
    visit.button("Exclude Root from binding").click()
    visit.expect_text("Root carries no weight any more")
    visit.settle()
    expect(visit.button("Stray weights")).to_have_count(0)
    mended = exported(visit, tmp_path)
    assert mended.skeleton.names[root] == "Root"
    assert not mended.weights[:, root].any()
    assert cutcell.bind(rig, SOLDIER).weights[vertex, root] > 0.5
    assert not mended.skeleton.deform[root], "so it stays mended when it is bound again"
    visit.panel("Weights")
    assert corrected(visit).joints == {"Root": JointEdit(deform=False)}
