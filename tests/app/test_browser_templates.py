"""A statue gets a skeleton in a browser, as a person gives it one, and leaves with it."""

import numpy as np
from axe_playwright_python.sync_playwright import Axe
from playwright.sync_api import expect

import cutcell
from cutcell_assets import demo_path
from tests.cutcell.cli.files import write_obj


def test_from_a_statue_to_a_character(visit, tmp_path):
    own = cutcell.load(demo_path("biped"))
    statue = write_obj(tmp_path / "statue.obj", own.mesh.vertices, own.mesh.faces)
    visit.go("?rig=robot&resolution=24")
    visit.dismiss()
    visit.open(statue)
    expect(visit.page.get_by_role("combobox", name="Skeleton")).to_be_visible()
    visit.settle()
    visit.choose("Skeleton", "Biped")
    visit.wait_until_bound()
    expect(visit.page.get_by_role("tab", name="Weights")).to_have_attribute("aria-selected", "true")
    field = visit.page.get_by_role("textbox", name="X", exact=True)
    field.fill("0.3")
    field.press("Enter")
    visit.settle()
    name = visit.page.get_by_role("textbox", name="Name", exact=True)
    name.fill("arm")
    name.press("Enter")
    visit.wait_until_bound()
    expect(visit.bone).to_contain_text("arm")
    with visit.page.expect_download() as saved:
        visit.button("Download the bound GLB").click()
    path = tmp_path / "bound.glb"
    saved.value.save_as(path)
    found = cutcell.load(path)
    assert {"arm", "upper_arm.R"} < {*found.skeleton.names}
    assert np.isclose(found.skeleton.joints[:, 0], 0.3, atol=1e-5).any()
    np.testing.assert_allclose(found.weights.sum(axis=1), 1, atol=1e-5)
    faults = [
        fault["id"]
        for fault in Axe().run(visit.page).response["violations"]
        if fault["impact"] in ("serious", "critical")
    ]
    assert faults == []
    visit.open(path)
    visit.wait_until_bound()
    expect(visit.page.get_by_role("combobox", name="Skeleton")).to_be_hidden()
