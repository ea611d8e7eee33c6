"""A page as a person has it: a server of its own, a Chromium, and eyes on its canvas."""

from __future__ import annotations

import io
import os
import re
import subprocess
import sys
import threading
import time
import weakref
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any
from urllib.parse import urlparse

import numpy as np
from PIL import Image
from playwright.sync_api import Browser, ConsoleMessage, Error, Locator, Page, expect

import cutcell
from tests.signals import reset_signals

ROOT = Path(__file__).resolve().parents[2]
START_SECONDS = 240
LOAD_MS = 120_000
BIND_MS = 240_000
expect.set_options(timeout=LOAD_MS)  # a loaded machine is slow, and patience costs nothing
ANSWER_MS = 10_000

# The server has finished all that the page has sent, what it answered is drawn, and that made the
# page send nothing more. A page that is loaded anew meanwhile never hears the answer.
SETTLED = """async (limit) => {
  const view = window.__cutcell
  const idle = view.serverIdle()
  const {sent} = window
  if (!await Promise.race([idle, new Promise((no) => setTimeout(no, limit))])) return false
  const {messages} = view
  // Widgets that came are built in pieces, between which the page has more to do.
  await new Promise(requestAnimationFrame)
  await new Promise((rests) => requestIdleCallback(rests, {timeout: limit}))
  return messages > 0 && view.report().idle && sent === window.sent && messages === view.messages
}"""

# Counts what the page sends. No measured speed decides how finely the page draws.
STEADY = """
  const {send} = WebSocket.prototype
  Object.assign(window, {sent: 0, sockets: [], drawsOnDemand: false})
  WebSocket.prototype.send = function (...parts) {
    if (!sockets.includes(this)) { sockets.push(this) }
    window.sent += 1
    send.apply(this, parts)
  }
  let view
  Object.defineProperty(Window.prototype, "__cutcell", {
    get: () => view?.gone ? undefined : view,  // the page deletes it when it ends
    set: (made) => {
      view = made
      const {smooth} = made.renderer
      const draw = smooth.draw.bind(smooth)
      Object.assign(smooth, {
        cost: {rough: 0, full: 0},
        time: () => {},
        draw: (...parts) => { if (!window.drawsOnDemand) { draw(...parts) } },
      })
    },
  })
"""

# Software rendering takes most of the time of a test: pixels are made only where a test looks at
# them. All else of a drawing (places, picks, what is seen of each actor) is computed as ever.
ON_DEMAND = "window.drawsOnDemand = true"

DRAW = """async () => {
  if (!window.drawsOnDemand) { return }
  await new Promise(requestAnimationFrame)
  window.drawsOnDemand = false
  __cutcell.renderer.draw(Boolean(__cutcell.playing), false)
  window.drawsOnDemand = true
}"""

SCALE = 0.5
"""Size of a picture in parts of the page's: to draw a quarter of the pixels takes less time."""

# One sample a pixel, not four: smooth edges take software rendering longer than all the rest.
ONE_SAMPLE = """
  WebGL2RenderingContext.prototype.renderbufferStorageMultisample = function (to, n, ...rest) {
    this.renderbufferStorage(to, ...rest)
  }
"""

# A vertex of the body for which something holds, and where a click means it.
IN_SIGHT = """(code) => {
  const view = window.__cutcell
  const wanted = new Function("vertex", `return ${code}`)
  const points = view.renderer.actors.get("body").rest.length / 3
  const box = view.overlay.canvas.getBoundingClientRect()
  for (let vertex = 0; vertex < points; vertex++) {
    if (!wanted(vertex)) { continue }
    // Whole pixels: others reach the page a little rounded, and on an outline that is a miss.
    const [x, y] = view.vertexPoint(vertex).map(Math.round)
    let top = document.elementFromPoint(x, y)
    while (top?.shadowRoot?.elementFromPoint(x, y)) { top = top.shadowRoot.elementFromPoint(x, y) }
    if (!view.overlay.canvas.contains(top)) { continue }  // a card or a button is over it
    const hit = view.pointer.under(x - box.left, y - box.top)
    if (hit?.vertex !== undefined && wanted(hit.vertex)) { return [hit.vertex, x, y] }
  }
}"""

# No control has the focus, as on a page that has just come.
BLUR = """() => {
  let part = document.activeElement
  while (part?.shadowRoot?.activeElement) { part = part.shadowRoot.activeElement }
  part?.blur()
}"""

# What is printed of a page where a test failed.
STATE = {
    "address": "location.search",
    "view": "JSON.stringify(window.__cutcell?.report())",
    "focus": """() => {
      let part = document.activeElement
      while (part?.shadowRoot?.activeElement) { part = part.shadowRoot.activeElement }
      return part?.outerHTML.slice(0, 300)
    }""",
    "texts": """() => {
      const seen = (node) => {
        if (node.nodeType === Node.TEXT_NODE) { return [node.data.trim()] }
        if (node instanceof Element) {
          const {display, visibility} = getComputedStyle(node)
          const isHidden = display === "none" || visibility === "hidden"
          if (isHidden || node.matches("style, script")) { return [] }
        }
        const children = node.shadowRoot?.childNodes ?? node.childNodes
        return [...children].flatMap(seen)
      }
      return seen(document.body).filter(Boolean).join(" | ")
    }""",
}

AT_FIRST_SIGHT = """(buttons, limit) => new Promise((seen, missed) => {
  const end = performance.now() + limit
  const look = () => {
    const button = buttons.find((one) => one.checkVisibility({visibilityProperty: true}))
    if (button) {
      seen(button.click())
    } else if (performance.now() > end) {
      missed(new Error("the button never shows"))
    } else {
      requestAnimationFrame(look)
    }
  }
  look()
})"""


GO = """query => {
  history.pushState(history.state, "", location.pathname + query)
  dispatchEvent(new PopStateEvent("popstate"))
}"""

# What a browser says of its own software rendering, never of the page.
OF_THE_BROWSER = re.compile(r"GL Driver Message|GroupMarkerNotSet|software WebGL|SwiftShader")


@contextmanager
def served(*arguments: str, program: Sequence[str] = ("cutcell",)) -> Iterator[str]:
    """Run `cutcell app` as a process of its own; give its address.

    Parameters
    ----------
    *arguments : str
        Of the command.
    program : sequence of str
        A module that runs the command, and arguments before those.
    """
    options = ["app", *arguments, "--no-show", "--port", "0"]
    command = [sys.executable, "-m", *program, *options]
    process = subprocess.Popen(
        command,
        cwd=ROOT,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        env={**os.environ, "PYTHONFAULTHANDLER": "1"},
        preexec_fn=reset_signals,
    )
    lines: list[str] = []
    listening = threading.Event()

    def read() -> None:
        assert process.stdout is not None
        for line in process.stdout:
            lines.append(line)
            if "http://" in line:
                listening.set()
        listening.set()

    reader = threading.Thread(target=read, daemon=True)
    reader.start()
    try:
        listening.wait(START_SECONDS)
        result = re.search(r"http://\S+", "".join(lines))
        assert result, "the server did not start:\n" + "".join(lines)
        yield result.group()
    finally:
        code = process.poll()
        process.terminate()
        process.wait(120)
        reader.join(5)
        assert process.stdout is not None
        process.stdout.close()
    assert code is None, f"the server ended by itself ({code}):\n" + "".join(lines)
    reports = "".join(lines)
    # A browser that leaves in mid-sentence makes the server's libraries grumble; we must not.
    assert "unexpected error" not in reports, reports
    assert str(ROOT / "app") not in reports, reports


visits: weakref.WeakSet[Visit] = weakref.WeakSet()
"""Pages that are open, for the report of a test that fails."""


class Visit:
    """One person's page, as a person sees it or, unless it is smooth, with fewer pixels to draw.

    A page that is not `smooth` draws only when a test looks at it, unless `draws` says otherwise.
    """

    def __init__(
        self, browser: Browser, url: str, smooth: bool = False, draws: bool = False, **context: Any
    ) -> None:
        size = {"width": 1100, "height": 720}
        scale = 1 if smooth else SCALE
        self.context = browser.new_context(
            **{"viewport": size, "accept_downloads": True, "device_scale_factor": scale, **context}
        )
        self.context.set_default_timeout(LOAD_MS)
        parts = (STEADY, "" if smooth else ONE_SAMPLE, "" if smooth or draws else ON_DEMAND)
        self.context.add_init_script("".join(parts))
        self.page: Page = self.context.new_page()
        self.requests: list[str] = []
        self.complaints: list[str] = []
        self.page.on("request", lambda request: self.requests.append(request.url))
        self.page.on("websocket", lambda socket: self.requests.append(socket.url))
        self.page.on("console", self._hear)
        self.page.on("pageerror", lambda error: self.complaints.append(str(error)))
        self.url = url
        visits.add(self)
        self.page.goto(url)

    def _hear(self, message: ConsoleMessage) -> None:
        if message.type in ("error", "warning") and not OF_THE_BROWSER.search(message.text):
            self.complaints.append(f"{message.type}: {message.text}")

    def close(self) -> None:
        """Leave; check what was heard until then."""
        self.context.close()
        visits.discard(self)
        self.check()

    def described(self) -> str:
        """Return what the page shows and says, to find the cause of a failure."""
        parts = [f"complaints: {self.complaints}"]
        for name, code in STATE.items():
            try:
                parts.append(f"{name}: {self.page.evaluate(code)}")
            except Error as error:
                parts.append(f"{name}: {error}")
        return "\n".join(parts)

    def check(self) -> None:
        """Check that nothing was complained of and no request left the machine; forget it."""
        asked = [url for url in self.requests if not _is_inline(url)]
        away = [url for url in asked if urlparse(url).hostname != "localhost"]
        assert not away, f"requests left the machine: {away[:3]}"
        complaints, self.complaints = self.complaints, []
        self.requests.clear()
        assert complaints == []

    @property
    def beginning(self) -> tuple[str, str]:
        """The address, and what the line at the bottom counts."""
        return self.address, self.status.inner_text().rpartition("|")[0]

    def remember_beginning(self) -> None:
        """Note what `begin_anew` goes back to."""
        self.first = self.beginning

    def begin_anew(self) -> bool:
        """Go back to how the page began; return whether it is as it was."""
        try:
            for _ in range(2):  # a card, and what is under it
                self.page.keyboard.press("Escape")
            self.page.evaluate(BLUR)
            self.page.mouse.move(2, 2)
            self.settle()
            if self.beginning != self.first:
                self.go(self.first[0])
            if self.button("Close").is_visible():
                self.dismiss()
            self.unfold()
            return self.beginning == self.first
        except (Error, AssertionError):
            return False

    @property
    def address(self) -> str:
        """The part of the page's address that names what it shows, once it is written."""
        self.settle()
        self.page.wait_for_function("window.__cutcell.addressBar.waiting === null")
        return self.page.evaluate("location.search")

    def go(self, query: str) -> None:
        """Go to another address of this page, as by the browser's Back: nothing is loaded anew."""
        self.page.evaluate(GO, query)
        self.settle()

    @property
    def status(self) -> Locator:
        """The line at the bottom, once the graph is counted."""
        return self.page.get_by_text(re.compile(r"interior, .* surface"))

    @property
    def bone(self) -> Locator:
        """The list that says which bone is chosen."""
        return self.page.get_by_role("combobox", name="Bone", exact=True)

    def wait_until_bound(self) -> None:
        """Wait until the weights are there and drawn."""
        self.status.wait_for(timeout=BIND_MS)
        self.settle()
        self.unfold()

    def dismiss(self) -> None:
        """Close the message over the canvas."""
        self.page.get_by_role("button", name="Close", exact=True).click()
        self.page.get_by_role("alert").wait_for(state="hidden")

    def settle(self) -> None:
        """Wait until all that was asked for is done, has arrived and is drawn."""
        self.page.wait_for_function("window.__cutcell?.messages")
        end = time.monotonic() + BIND_MS / 1000
        while not self.page.evaluate(SETTLED, ANSWER_MS):
            assert time.monotonic() < end, f"it never settles: {self.report()}"

    def look(self) -> np.ndarray:
        """Return the canvas as it is seen, shape (height, width, 3), int."""
        self.page.mouse.move(2, 2)
        self.settle()
        self.page.evaluate(DRAW)
        picture = self.page.get_by_role("application").screenshot()
        with Image.open(io.BytesIO(picture)) as image:
            return np.asarray(image.convert("RGB")).astype(int)

    def report(self) -> dict[str, Any]:
        """Return what the view says of itself."""
        return self.page.evaluate("window.__cutcell.report()")

    def points(self, name: str = "body") -> np.ndarray:
        """Return where an actor's points are now, shape (n, 3)."""
        code = "name => Array.from(__cutcell.renderer.actors.get(name).posed())"
        return np.array(self.page.evaluate(code, name)).reshape(-1, 3)

    def button(self, name: str, exact: bool = True) -> Locator:
        """Return a button."""
        return self.page.get_by_role("button", name=name, exact=exact)

    def click_when_seen(self, name: str) -> None:
        """Press a button in the first frame that shows it: it may be there for a moment only."""
        hidden = self.page.get_by_role("button", name=name, exact=True, include_hidden=True)
        hidden.evaluate_all(AT_FIRST_SIGHT, LOAD_MS)

    def panel(self, title: str) -> None:
        """Choose a panel."""
        self.page.get_by_role("tab", name=title, exact=True).click()
        self.settle()
        self.unfold()

    def unfold(self) -> None:
        """Open all sections of the panel."""
        headings = self.page.locator(".MuiAccordionSummary-root[aria-expanded=false]:visible")
        # By script: on a narrow page a heading may be below the edge of the sheet.
        # A section that is shown later, or is drawn again as it is clicked, is folded once more.
        while headings.count():
            headings.evaluate_all("all => all.forEach((heading) => heading.click())")
            self.settle()

    def reach(self, control: Locator) -> Locator:
        """Open sections until a control is seen: one that is drawn again late is folded."""
        end = time.monotonic() + LOAD_MS / 1000
        while not control.is_visible():
            assert time.monotonic() < end, f"no section shows {control}"
            self.unfold()
            self.settle()
        return control

    def switch(self, name: str) -> None:
        """Turn a switch over."""
        self.page.get_by_role("switch", name=name, exact=True).click()

    def choose(self, label: str, option: str) -> None:
        """Take an option of a menu."""
        self.page.get_by_role("combobox", name=label, exact=True).click()
        self.page.get_by_role("menuitem", name=option, exact=True).click()
        # Until the menu is gone, and not only its entries, its curtain takes what is clicked.
        expect(self.page.locator(".MuiPopover-root")).to_have_count(0)

    def slide(self, label: str, key: str, times: int = 1) -> None:
        """Move a slider by a key."""
        slider = self.page.get_by_role("slider", name=label)
        slider.focus()
        for _ in range(times):
            slider.press(key)

    def drop(self, *paths: Path) -> None:
        """Give files to the page."""
        self.page.locator("input[type=file]").first.set_input_files([str(path) for path in paths])

    def open(self, path: Path, *beside: Path) -> None:
        """Give a file of a character to the page, with others; wait until its weights are there."""
        count = len(cutcell.load(path).mesh.vertices)
        # What is dropped while the page still loads may be opened before what its address names.
        self.page.wait_for_function("window.__cutcell?.report().actors.body")
        self.drop(path, *beside)
        self.page.get_by_text(re.compile(f"^{count:,} vertices .* surface")).wait_for()
        self.settle()

    def click_bone(self, joint: int) -> None:
        """Click the middle of a joint's bone in the canvas."""
        x, y = self.page.evaluate("joint => __cutcell.bonePoint(joint)", joint)
        self.page.mouse.click(x, y)

    @property
    def card(self) -> Locator:
        """The card of a clicked vertex."""
        return self.page.get_by_role("region", name=re.compile("Vertex"))

    def click_vertex(self, code: str = "true") -> int:
        """Click a vertex of the body for which the click means that vertex; return its index.

        Parameters
        ----------
        code : str
            What must be true of `vertex`, in JavaScript.
        """
        self.settle()
        result = self.page.evaluate(IN_SIGHT, code)
        assert result, "no such vertex is in sight"
        self.page.mouse.click(result[1], result[2])
        expect(self.card).to_have_attribute("aria-label", f"Vertex {result[0]}")
        return int(result[0])

    def close_card(self) -> None:
        """Leave the clicked vertex."""
        self.page.keyboard.press("Escape")
        expect(self.card).to_have_count(0)

    def expect_text(self, text: str | re.Pattern[str]) -> None:
        """Wait until some text is seen."""
        expect(self.page.get_by_text(text).filter(visible=True).first).to_be_visible()


def changed(before: np.ndarray, after: np.ndarray) -> float:
    """Return the part of the pixels that differ between two pictures."""
    assert before.shape == after.shape
    return float((np.abs(before - after).max(axis=2) > 8).mean())


def _is_inline(url: str) -> bool:
    return url.startswith(("data:", "blob:", "about:"))
