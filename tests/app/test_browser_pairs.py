"""The pairs of an audit in a browser."""

import re

import pytest
from playwright.sync_api import expect

from cutcell_lab.dataset import load_audit
from tests.app.audits import saved_audit
from tests.app.browser import Visit, changed, served
from tests.app.test_browser_accessibility import faults

pytestmark = pytest.mark.nightly


def test_pairs_are_stepped_through_and_overruled(browser, tmp_path):
    folder = saved_audit(tmp_path)
    with served("--pairs", str(folder)) as url:
        visit = Visit(browser, url)
        visit.expect_text("Pair 1 of 3.")
        visit.settle()
        first = visit.look()
        expect(visit.page.get_by_role("combobox", name="Bone", exact=True)).to_have_count(0)
        visit.button("Next").click()
        visit.expect_text("Pair 2 of 3.")
        visit.settle()
        assert changed(first, visit.look()) > 0.001
        visit.button("Different").click()
        visit.settle()
        visit.button("Next").click()
        visit.expect_text("Pair 3 of 3.")
        visit.settle()
        visit.button("Different").click()
        visit.expect_text(re.compile(r"2 of 3 characters are kept"))
        visit.page.reload()
        visit.expect_text("Pair 3 of 3.")
        visit.settle()
        expect(visit.button("Different")).to_have_attribute("aria-pressed", "true")
        assert faults(visit) == []
        visit.close()
    assert list(load_audit(folder).verdicts.values()) == ["different"] * 2
