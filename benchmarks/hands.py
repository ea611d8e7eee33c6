"""Clicks and keys of a person on the page, counted."""

from __future__ import annotations

import re
from collections.abc import Callable
from pathlib import Path

from playwright.sync_api import Locator

from tests.app.browser import Visit


class Hands:
    """What a person does on a page, and how often.

    Parameters
    ----------
    visit : Visit
    """

    def __init__(self, visit: Visit) -> None:
        self.visit = visit
        self.page = visit.page
        self.actions = 0

    def panel(self, title: str) -> None:
        """Choose a panel."""
        self._click(self.page.get_by_role("tab", name=title, exact=True))

    def section(self, title: str) -> None:
        """Open a section; one that is open already takes no action."""
        heading = self.page.get_by_role("button", name=title, exact=True)
        if heading.get_attribute("aria-expanded") != "true":
            self._click(heading)

    def press(self, name: str | re.Pattern[str], exact: bool = True) -> None:
        """Press a button."""
        self._click(self.page.get_by_role("button", name=name, exact=exact))

    def choose(self, label: str, option: str) -> None:
        """Take an option of a list."""
        self._acts(lambda: self.visit.choose(label, option))

    def menu(self, name: str, item: str) -> None:
        """Take an item of a menu."""

        def take() -> None:
            self.page.get_by_role("button", name=name, exact=True).click()
            self.page.get_by_role("menuitem", name=item, exact=True).click()

        self._acts(take)

    def type(self, label: str, text: str) -> None:
        """Type a text into a field."""
        field = self.page.get_by_label(label)

        def enter() -> None:
            field.fill(text)
            field.press("Enter")

        self._acts(enter)

    def key(self, label: str, key: str) -> None:
        """Press a key on a slider."""
        slider = self.page.get_by_role("slider", name=label, exact=True)
        self._acts(lambda: slider.press(key))

    def part(self, *words: str) -> None:
        """Choose the part whose row has some words: its mesh and the joint that it follows."""
        rows = self.page.get_by_role("list", name="Parts of the mesh").get_by_role("button")
        for word in words:
            rows = rows.filter(has_text=word)
        self._click(rows)

    def export(self, path: Path) -> None:
        """Export the character."""
        self.section("Export")
        with self.page.expect_download() as saved:
            self._acts(self.visit.button("Export GLB").click)
        saved.value.save_as(path)

    def _click(self, control: Locator) -> None:
        self._acts(control.click)

    def _acts(self, act: Callable[[], object]) -> None:
        act()
        self.visit.settle()
        self.actions += 1
