"""Clothes dropped in a browser, as a person does: seen, faded, exported, undone."""

import numpy as np
import pytest
from playwright.sync_api import expect

import cutcell
from cutcell import TriangleMesh
from tests.app.test_browser_accessibility import faults
from tests.app.test_browser_correct import exported
from tests.cutcell.cli.files import write_obj

pytestmark = pytest.mark.slow
FIELD = "Drop a mesh here, or browse"


def test_clothes_open_with_the_weights_and_are_exported_and_undone(visit, small, tmp_path):
    own, page = visit.address, visit.page
    middle = small.mesh.bounds.mean(axis=0)
    coat = TriangleMesh((small.mesh.vertices - middle) * 1.02 + middle, small.mesh.faces)
    body = exported(visit, tmp_path)
    expected = cutcell.transfer(body, coat)
    visit.unfold()
    page.get_by_role("slider", name="Angle of normals").focus()
    page.keyboard.press("Shift+Tab")
    page.keyboard.press("Shift+Tab")
    expect(page.get_by_label(FIELD)).to_be_focused()
    path = write_obj(tmp_path / "coat.obj", coat.vertices, coat.faces)
    page.get_by_label(FIELD).set_input_files(str(path))
    visit.expect_text(f"coat.obj: {len(coat.vertices)} matched.")
    visit.expect_text(f"Matched: {len(coat.vertices)}")
    visit.expect_text("Transferred from small")
    visit.dismiss()
    assert faults(visit) == []
    result = exported(visit, tmp_path)
    np.testing.assert_allclose(result.mesh.vertices, coat.vertices, atol=1e-6)
    np.testing.assert_allclose(result.weights, expected.weights, atol=1e-5)
    visit.button("Undo").click()
    visit.settle()
    assert visit.address == own
    path = write_obj(tmp_path / "far.obj", np.add(coat.vertices, [9, 0, 0]), coat.faces)
    page.get_by_label(FIELD).set_input_files(str(path))
    expect(page.get_by_role("alert")).to_contain_text("far.obj")
    visit.settle()
    assert visit.address == own
