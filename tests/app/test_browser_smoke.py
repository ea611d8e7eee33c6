"""One journey in a browser: a character is opened, bound, and leaves with its weights."""

import shutil

import numpy as np

import cutcell
from cutcell_assets import demo_path
from tests.app.browser import changed
from tests.app.small import RESOLUTION
from tests.conftest import SHARED_RIGS


def test_a_file_goes_in_and_the_bound_one_comes_out(visit, tmp_path):
    real = SHARED_RIGS / "khronos_CesiumMan.glb"
    source = real if real.exists() else demo_path("rabbit")
    path = tmp_path / "my character.glb"
    shutil.copy(source, path)
    rig = cutcell.load(path)
    visit.page.evaluate("window.drawsOnDemand = false")  # as for people: it draws by itself
    before = visit.look()
    visit.open(path)
    assert changed(before, visit.look()) > 0.02
    visit.button("Computed").click()
    visit.settle()
    with visit.page.expect_download() as download:
        visit.button("Export GLB", exact=False).click()
    bound = tmp_path / download.value.suggested_filename
    assert bound.name == "my character-bound.glb"
    download.value.save_as(bound)
    loaded = cutcell.load(bound)
    np.testing.assert_array_equal(loaded.mesh.vertices, rig.mesh.vertices)
    expected = cutcell.bind(rig, RESOLUTION).weights
    np.testing.assert_allclose(loaded.weights, expected, atol=1e-6)
    visit.page.evaluate("window.drawsOnDemand = true")
