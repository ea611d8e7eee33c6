"""The interactive page in one file, opened from the disk."""

import re

import numpy as np
import pytest
from playwright.sync_api import expect

from cutcell_app.render.interactive import interactive_page
from cutcell_assets import demo_path
from tests.app.browser import IN_SIGHT, Visit, changed

MAX_BYTES = 10_000_000
FRAMED = """<!doctype html><iframe style="width:320px;height:240px" srcdoc="{}"></iframe>"""


class Alone(Visit):
    """A page without a server."""

    def settle(self):
        self.page.wait_for_function("window.__cutcell?.report().idle && __cutcell.messages")
        self.page.evaluate("new Promise((drawn) => requestAnimationFrame(() => setTimeout(drawn)))")

    def select(self, label, option):
        self.page.get_by_role("combobox", name=label).select_option(label=option)


@pytest.fixture(scope="module")
def written(robot, tmp_path_factory):
    path = tmp_path_factory.mktemp("page") / "robot.html"
    path.write_text(interactive_page(robot), encoding="utf-8")
    return path


@pytest.fixture
def page(browser, written):
    alone = Alone(browser, written.as_uri())
    alone.settle()
    yield alone
    alone.context.close()
    assert [url for url in alone.requests if not url.startswith(("data:", "blob:"))] == [alone.url]
    assert alone.complaints == []
