"""Joints, parts and vertices corrected in a browser, as a person does."""

import json
import re

import numpy as np
import pytest
from axe_playwright_python.sync_playwright import Axe
from playwright.sync_api import expect

import cutcell
from cutcell import Corrections, JointCorrection
from tests.app.browser import Visit


@pytest.fixture(scope="module")
def visit(browser, url):
    """Show the robot, coarse: each binding is quick."""
    visit = Visit(browser, url + "/?rig=robot&resolution=24&bone=hips")
    visit.wait_until_bound()
    visit.dismiss()
    yield visit
    visit.close()


@pytest.fixture(autouse=True)
def anew(visit):
    yield
    if visit.page.get_by_role("button", name="Take all back").is_enabled():
        visit.button("Take all back").click()
        visit.settle()


def corrected(visit):
    """Return the corrections that the page saves."""
    with visit.page.expect_download() as saved:
        visit.button("Save").click()
    return Corrections.load(saved.value.path())


def exported(visit, tmp_path):
    """Return the character that the page exports."""
    with visit.page.expect_download() as saved:
        visit.button("Download the bound GLB").click()
    path = tmp_path / "bound.glb"
    saved.value.save_as(path)
    return cutcell.load(path)


def faults(visit):
    found = Axe().run(visit.page, options={"resultTypes": ["violations"]})
    return [
        f"{fault['id']}: {node['html'][:200]}"
        for fault in found.response["violations"]
        if fault["impact"] in ("serious", "critical")
        for node in fault["nodes"]
    ]


def test_joints_are_corrected_by_keys_kept_and_exported(visit, robot, tmp_path):
    tree = visit.page.get_by_role("tree", name="Joints")
    hips = tree.get_by_role("treeitem", name=re.compile("^hips"))
    expect(hips).to_have_attribute("aria-selected", "true")
    hips.focus()
    for key in ("ArrowLeft", "ArrowRight", "End", "Enter"):  # close, open, to the last one
        visit.page.keyboard.press(key)
    last = tree.get_by_role("treeitem").last
    expect(last).to_be_focused()
    name = robot.skeleton.names[-1]
    expect(visit.bone).to_have_text(name)
    visit.page.keyboard.press(" ")
    expect(last).to_have_attribute("aria-checked", "false")
    visit.switch("Keeps the file's weights")
    visit.slide("Reach", "ArrowRight", 5)
    visit.settle()
    assert faults(visit) == []
    expected = {name: JointCorrection(deform=False, locked=True, gain=2**0.5)}
    held = corrected(visit).joints
    assert held.keys() == expected.keys()
    assert held[name].gain == pytest.approx(2**0.5, abs=1e-3)
    assert (held[name].deform, held[name].locked) == (False, True)

    visit.page.reload()
    visit.wait_until_bound()
    visit.dismiss()
    assert corrected(visit).joints == held
    weights = exported(visit, tmp_path).weights
    fresh = cutcell.bind(robot, 24, corrections=Corrections(joints=held))
    np.testing.assert_allclose(weights, fresh.weights, atol=1 / 255)
    visit.button("Take all back").click()
    visit.settle()
    expect(visit.page.get_by_text("Nothing is corrected")).to_be_visible()
    visit.button("Undo").click()
    visit.settle()
    assert corrected(visit).joints == held
    path = tmp_path / "mine.json"
    path.write_text(json.dumps({"joints": {robot.skeleton.names[0]: {"gain": 2}}}))
    with visit.page.expect_file_chooser() as chooser:
        visit.button("Open").click()
    chooser.value.set_files(path)
    expect(tree.get_by_text("×2")).to_be_visible()
    visit.settle()
    assert corrected(visit) == Corrections.load(path)
