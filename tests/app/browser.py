"""A page as a person has it: a server of its own, a Chromium, and eyes on its canvas."""

from __future__ import annotations

import io
import os
import re
import subprocess
import sys
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any
from urllib.parse import urlparse

import numpy as np
from PIL import Image
from playwright.sync_api import Browser, ConsoleMessage, Locator, Page, expect

ROOT = Path(__file__).resolve().parents[2]
START_SECONDS = 60
LOAD_MS = 60_000
BIND_MS = 120_000
SETTLED = """() => {
  const view = window.__cutcell
  if (!view || !view.messages) return false
  const now = JSON.stringify(view.report())
  const same = now === window.__before
  window.__before = now
  return same && view.report().idle
}"""

# What a browser says of its own software rendering, never of the page.
OF_THE_BROWSER = re.compile(r"GL Driver Message|GroupMarkerNotSet|software WebGL|SwiftShader")


@contextmanager
def served(*arguments: str) -> Iterator[str]:
    """Run `cutcell app` as a process of its own; give its address."""
    command = [sys.executable, "-m", "cutcell", "app", *arguments, "--no-show", "--port", "0"]
    process = subprocess.Popen(
        command,
        cwd=ROOT,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        env={**os.environ, "PYTHONFAULTHANDLER": "1"},
    )
    lines: list[str] = []
    known = threading.Event()

    def read() -> None:
        assert process.stdout is not None
        for line in process.stdout:
            lines.append(line)
            if "http://" in line:
                known.set()
        known.set()

    reader = threading.Thread(target=read, daemon=True)
    reader.start()
    try:
        known.wait(START_SECONDS)
        found = re.search(r"http://\S+", "".join(lines))
        assert found, "the server did not start:\n" + "".join(lines)
        yield found.group()
    finally:
        code = process.poll()
        process.terminate()
        process.wait(20)
        reader.join(5)
        assert process.stdout is not None
        process.stdout.close()
    assert code is None, f"the server ended by itself ({code}):\n" + "".join(lines)
    told = "".join(lines)
    # A browser that leaves in mid-sentence makes the server's libraries grumble; we must not.
    assert "unexpected error" not in told, told
    assert str(ROOT / "app") not in told, told


class Visit:
    """One person's page."""

    def __init__(self, browser: Browser, url: str, **context: Any) -> None:
        self.context = browser.new_context(
            **{"viewport": {"width": 1100, "height": 720}, "accept_downloads": True, **context}
        )
        self.page: Page = self.context.new_page()
        self.requests: list[str] = []
        self.complaints: list[str] = []
        self.page.on("request", lambda request: self.requests.append(request.url))
        self.page.on("websocket", lambda socket: self.requests.append(socket.url))
        self.page.on("console", self._hear)
        self.page.on("pageerror", lambda error: self.complaints.append(str(error)))
        self.url = url
        self.page.goto(url)

    def _hear(self, message: ConsoleMessage) -> None:
        if message.type in ("error", "warning") and not OF_THE_BROWSER.search(message.text):
            self.complaints.append(f"{message.type}: {message.text}")

    def close(self) -> None:
        """Leave; check that nothing was complained of and no request left the machine."""
        self.context.close()
        hosts = {urlparse(url).hostname for url in self.requests if not _is_inline(url)}
        assert hosts <= {"localhost"}, f"requests went to {hosts}"
        assert self.complaints == []

    def wait_until_bound(self) -> None:
        """Wait until the weights are there and drawn."""
        self.page.get_by_text(re.compile(r"interior, .* surface")).wait_for(timeout=BIND_MS)
        self.settle()

    def dismiss(self) -> None:
        """Close the message over the canvas."""
        self.page.get_by_role("button", name="Close", exact=True).click(timeout=LOAD_MS)
        self.page.get_by_role("alert").wait_for(state="hidden", timeout=LOAD_MS)

    def settle(self) -> None:
        """Wait until nothing is on its way and nothing is drawn any more."""
        self.page.wait_for_timeout(250)
        self.page.wait_for_function(SETTLED, timeout=LOAD_MS, polling=250)

    def look(self) -> np.ndarray:
        """Return the canvas as it is seen, shape (height, width, 3), int."""
        self.page.mouse.move(2, 2)
        self.settle()
        picture = self.page.get_by_role("application").screenshot()
        with Image.open(io.BytesIO(picture)) as image:
            return np.asarray(image.convert("RGB")).astype(int)

    def report(self) -> dict[str, Any]:
        """Return what the view says of itself."""
        return self.page.evaluate("window.__cutcell.report()")

    def points(self, name: str = "body") -> np.ndarray:
        """Return where an actor's points are now, shape (n, 3)."""
        code = "name => Array.from(__cutcell.stage.figures.get(name).posed())"
        return np.array(self.page.evaluate(code, name)).reshape(-1, 3)

    def button(self, name: str, exact: bool = True) -> Locator:
        """Return a button."""
        return self.page.get_by_role("button", name=name, exact=exact)

    def panel(self, title: str) -> None:
        """Choose a panel."""
        self.page.get_by_role("tab", name=title, exact=True).click()
        self.settle()

    def switch(self, name: str) -> None:
        """Turn a switch over."""
        self.page.get_by_role("switch", name=name, exact=True).click()

    def choose(self, label: str, option: str) -> None:
        """Take an option of a menu."""
        self.page.get_by_role("combobox", name=label).click()
        self.page.get_by_role("menuitem", name=option, exact=True).click()
        # Until the menu is gone, and not only its entries, its curtain takes what is clicked.
        expect(self.page.locator(".MuiPopover-root")).to_have_count(0, timeout=LOAD_MS)

    def slide(self, label: str, key: str, times: int = 1) -> None:
        """Move a slider by a key."""
        slider = self.page.get_by_role("slider", name=label)
        slider.focus()
        for _ in range(times):
            slider.press(key)

    def drop(self, *paths: Path) -> None:
        """Give files to the page."""
        self.page.locator("input[type=file]").set_input_files([str(path) for path in paths])

    def click_bone(self, joint: int) -> None:
        """Click the middle of a joint's bone in the canvas."""
        x, y = self.page.evaluate("joint => __cutcell.bonePoint(joint)", joint)
        self.page.mouse.click(x, y)

    def click_vertex(self, vertex: int) -> None:
        """Click where a vertex of the body is in the canvas."""
        x, y = self.page.evaluate("vertex => __cutcell.vertexPoint(vertex)", vertex)
        self.page.mouse.click(x, y)

    def expect_text(self, text: str | re.Pattern[str]) -> None:
        """Wait until some text is seen."""
        expect(self.page.get_by_text(text).first).to_be_visible(timeout=LOAD_MS)


def changed(before: np.ndarray, after: np.ndarray) -> float:
    """Return the part of the pixels that differ between two pictures."""
    assert before.shape == after.shape
    return float((np.abs(before - after).max(axis=2) > 8).mean())


def _is_inline(url: str) -> bool:
    return url.startswith(("data:", "blob:", "about:"))
