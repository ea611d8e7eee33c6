"""What a person starts while weights are computed is completed beside them."""

import re
import time

import pytest

import cutcell
from cutcell_assets import demo_path
from tests.app.browser import GO, LOAD_MS

pytestmark = pytest.mark.slow


def test_exports_films_and_findings_come_though_weights_are_computed(visit, tmp_path):
    robot, files = cutcell.load(demo_path("robot")), {}

    def save(download):
        path = tmp_path / download.suggested_filename
        download.save_as(path)
        files[path.suffix] = path

    visit.page.on("download", save)
    visit.page.evaluate(GO, "?rig=robot&resolution=160")
    visit.page.wait_for_function("location.search.includes('bone=')")  # the character is open
    visit.button("Export GLB").click()
    visit.button("Image, video").click()
    visit.page.get_by_role("menuitem", name="Turntable (GIF)").click()
    visit.page.get_by_role("tab", name="Check", exact=True).click()
    visit.page.get_by_role("tab", name="Pose", exact=True).click()
    visit.slide("About Z", "PageUp", 3)
    visit.settle()
    end = time.monotonic() + LOAD_MS / 1000
    while len(files) < 2 and time.monotonic() < end:  # files come a moment after the page is idle
        visit.page.wait_for_timeout(20)
    assert files.keys() == {".glb", ".gif"}
    assert files[".gif"].read_bytes().startswith(b"GIF8")
    weights = cutcell.bind(robot, 160).weights
    assert abs(cutcell.load(files[".glb"]).weights - weights).max() < 1e-6
    visit.panel("Check")
    visit.expect_text(re.compile("Choose one to see it"))
