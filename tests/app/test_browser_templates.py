"""A statue gets a skeleton in a browser, as a person gives it one, and leaves with it."""

import numpy as np
import pytest
from playwright.sync_api import expect

import cutcell
from cutcell_assets import demo_path
from cutcell_viewers.character import to_scene
from tests.app.browser import SCALE, changed
from tests.app.test_browser_accessibility import faults
from tests.cutcell.cli.files import write_obj
from tests.viewers.textures import COLORS, png, squares

pytestmark = pytest.mark.slow


def test_from_a_statue_to_a_character(visit, tmp_path):
    own = cutcell.load(demo_path("biped"))
    statue = write_obj(tmp_path / "statue.obj", own.mesh.vertices, own.mesh.faces)
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
        visit.button("Export GLB").click()
    path = tmp_path / "bound.glb"
    saved.value.save_as(path)
    result = cutcell.load(path)
    assert {"arm", "upper_arm.R"} < {*result.skeleton.names}
    assert np.isclose(result.skeleton.joints[:, 0], 0.3, atol=1e-5).any()
    np.testing.assert_allclose(result.weights.sum(axis=1), 1, atol=1e-5)
    assert faults(visit) == []
    visit.open(path)
    visit.wait_until_bound()
    expect(visit.page.get_by_role("combobox", name="Skeleton")).to_be_hidden()


@pytest.fixture
def painted(tmp_path):
    """Write a statue as OBJ, with a material and its image; return the three files."""
    own = cutcell.load(demo_path("biped"))
    points = to_scene(own, own.mesh.vertices)
    low, high = points.min(axis=0), points.max(axis=0)
    uv = ((points - low) / (high - low))[:, :2]
    lines = ["mtllib statue.mtl", "usemtl paint"]
    lines += [f"v {x} {y} {z}" for x, y, z in points]
    lines += [f"vt {u} {v}" for u, v in uv]
    lines += [f"f {a}/{a} {b}/{b} {c}/{c}" for a, b, c in own.mesh.faces + 1]
    files = [tmp_path / f"statue.{end}" for end in ("obj", "mtl", "png")]
    files[0].write_text("\n".join(lines))
    files[1].write_text("newmtl paint\nmap_Kd C:\\art\\statue.png\n")
    files[2].write_bytes(png(squares()))
    return files


@pytest.mark.nightly
def test_a_statue_is_seen_in_its_materials_as_it_moves(visit, painted):
    visit.open(*painted)
    visit.choose("Skeleton", "Biped")
    visit.wait_until_bound()
    visit.panel("Pose")
    weights = visit.look()
    visit.button("Materials").click()
    pixels = visit.look()
    assert changed(weights, pixels) > 0.02
    expect(visit.page.get_by_text("cannot be shown")).to_have_count(0)
    for color in COLORS.reshape(4, 3).astype(int):
        near = np.abs(pixels / pixels.max(axis=2, keepdims=True) - color / color.max())
        assert (near.max(axis=2) < 0.15).sum() > 300 * SCALE**2, color
