"""Trained networks on the page's panel Compare, in a browser."""

import pytest
from playwright.sync_api import expect, sync_playwright

from cutcell_assets import demo_path
from cutcell_lab.networks import Recipe, train
from tests.app.browser import Visit, served
from tests.app.conftest import LIGHT
from tests.conftest import chromium  # noqa: F401 - a fixture


@pytest.fixture(scope="module")
def url(two, tmp_path_factory):
    folder = tmp_path_factory.mktemp("runs")
    for name in ("good", "spoiled"):
        train(Recipe("unirig", prior="bind", points=64, seed=len(name)), two, 1, folder / name)
    with served(str(demo_path("robot")), "--networks", str(folder)) as url:
        (folder / "spoiled" / "network.pt").write_bytes(b"no network")  # after it was listed
        yield url


def test_a_trained_network_stands_beside_the_others(url, chromium):  # noqa: F811
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=chromium, args=list(LIGHT))
        visit = Visit(browser, url)
        visit.wait_until_bound()
        visit.panel("Compare")
        row = visit.page.get_by_role("row").filter(has_text="UniRig with bind, tiny, seed 4")
        row.get_by_role("checkbox").check()
        expect(row.get_by_role("cell").nth(3)).not_to_have_text("")
        l1, deformation, seconds = map(float, row.get_by_role("cell").all_inner_texts()[1:])
        assert 0 < l1 < 1  # as a residual to `bind` it begins where that is
        assert deformation > 0
        assert seconds > 0
        visit.settle()
        captions = visit.page.locator(".caption").all_inner_texts()
        assert captions[-1] == "UniRig with bind, tiny, seed 4"
        row.get_by_role("checkbox").uncheck()
        spoiled = visit.page.get_by_role("row").filter(has_text="UniRig with bind, tiny, seed 7")
        spoiled.get_by_role("checkbox").check()
        visit.page.get_by_text("is no network that cutcell trained").wait_for()
        visit.settle()
        visit.close()
        browser.close()
