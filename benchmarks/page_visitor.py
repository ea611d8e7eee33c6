"""A browser's page, and the watch over its canvas: when what was changed is seen."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import panel as pn
from playwright.sync_api import Browser, Page

from cutcell_app.widgets.modules import STATIC

from .page_subjects import SIZE, Subject

PATIENCE = 900.0
WATCH = (Path(__file__).parent / "page_watch.js").read_text(encoding="utf-8")


@contextmanager
def served(subjects: Sequence[Subject], port: int) -> Iterator[str]:
    """Serve the subjects from a thread of this process; give the address."""
    server = pn.serve(
        {subject.path: subject.page for subject in subjects},
        static_dirs=STATIC, port=port, threaded=True, show=False, verbose=False,
        websocket_origin=f"localhost:{port}", websocket_max_message_size=2**28,
    )  # fmt: skip
    try:
        yield f"http://localhost:{port}"
    finally:
        server.stop()


class Watched:
    """A browser's page whose canvas is watched.

    Parameters
    ----------
    browser : Browser
    url : str
        The page.
    width, height : int
        Of the window.
    """

    def __init__(self, browser: Browser, url: str, width: int, height: int) -> None:
        self.page: Page = browser.new_page(viewport={"width": width, "height": height})
        self.page.add_init_script(WATCH)
        begin = time.time()
        self.page.goto(url, timeout=1000 * PATIENCE)
        self.first_picture = self.wait("watch.painted") - begin

    def wait(self, what: str) -> float:
        """Return when something came to be, in seconds of the machine's clock."""
        handle = self.page.wait_for_function(what, timeout=1000 * PATIENCE, polling=20)
        return float(handle.json_value()) / 1000

    def settle(self) -> None:
        """Wait until nothing moves; from now on the first change counts."""
        self.page.evaluate("watch.settle()")
        self.page.evaluate("watch.expect()")

    def seen_after_key(self, key: str) -> float:
        """Press a key; return the seconds from its event in the browser to changed pixels."""
        self.settle()
        self.page.evaluate("watch.hear('keydown')")
        self.page.keyboard.press(key)
        return self.wait("watch.changed") - self.wait("watch.heard")


class Visitor(Watched):
    """A page with one subject."""

    def __init__(self, browser: Browser, url: str, subject: Subject) -> None:
        super().__init__(browser, url + subject.path, 860, 660)
        self.subject = subject

    def seen_after(self, change: Callable[[], None]) -> float:
        """Return the seconds from a change in Python to changed pixels."""
        self.settle()
        begun: list[float] = []

        def act() -> None:
            begun.append(time.time())
            change()

        self.subject.document.add_next_tick_callback(act)
        changed_at = self.wait("watch.changed")
        return changed_at - begun[0]

    def orbit(self, steps: int = 25) -> list[float]:
        """Drag over the canvas; return the seconds between frames."""
        self.page.evaluate("watch.stop()")
        x, y = SIZE[0] / 2, SIZE[1] / 2
        self.page.mouse.move(x, y)
        self.page.mouse.down()
        self.page.mouse.move(x + 8, y)
        self.page.evaluate("watch.count()")
        for step in range(steps):
            self.page.mouse.move(x + 8 + 5 * step, y + 2 * step)
        frames = self.page.evaluate("watch.counted()")
        self.page.mouse.up()
        self.page.wait_for_timeout(500)
        return [frame / 1000 for frame in frames]

    def turns(self, whole: bool, steps: int = 12) -> list[float]:
        """Turn our view step by step; return the seconds until each picture is finished.

        With `whole` all lines are drawn, with smooth edges and in full, as they are at rest.
        """
        self.page.evaluate("watch.stop()")
        return [spent / 1000 for spent in self.page.evaluate(TURNS, [whole, steps])]

    def play(self, for_seconds: float) -> tuple[float, float]:
        """Play a motion; return the script seconds a frame, and the seconds a frame."""
        self.page.evaluate("watch.stop()")
        self.subject.document.add_next_tick_callback(lambda: self.subject.play(True))
        self.page.wait_for_function("__cutcell.report().playing")
        self.page.wait_for_timeout(1500)
        client = self.page.context.new_cdp_session(self.page)
        client.send("Performance.enable")
        before = self._script(client)
        self.page.wait_for_timeout(1000 * for_seconds)
        after = self._script(client)
        self.subject.document.add_next_tick_callback(lambda: self.subject.play(False))
        self.page.wait_for_function("!__cutcell.report().playing")
        frames = after["frames"] - before["frames"]
        script = (after["ScriptDuration"] - before["ScriptDuration"]) / frames
        return script, (after["Timestamp"] - before["Timestamp"]) / frames

    def on_processor(self, repeats: int = 15) -> list[float]:
        """Return the seconds that the same pose takes without the graphics card."""
        return [spent / 1000 for spent in self.page.evaluate(POSED, repeats)]

    def _script(self, client: Any) -> dict[str, float]:
        metrics = client.send("Performance.getMetrics")["metrics"]
        frames = self.page.evaluate("__cutcell.report().frames")
        return {**{one["name"]: one["value"] for one in metrics}, "frames": frames}


TURNS = """async ([whole, steps]) => {
  const {orbit, renderer} = __cutcell
  const draw = renderer.draw
  if (whole) { renderer.draw = function () { draw.call(this, false, true) } }
  const spent = []
  for (let step = 0; step <= steps; step++) {
    const [begin, frames] = [performance.now(), renderer.frames]
    orbit.turn(0.03, 0.004)
    while (renderer.frames === frames) { await new Promise(requestAnimationFrame) }
    renderer.context.readPixels(0, 0, 1, 1, renderer.context.RGBA, renderer.context.UNSIGNED_BYTE,
      new Uint8Array(4))
    if (step > 0) { spent.push(performance.now() - begin) }  // the first makes buffers
  }
  delete renderer.draw
  orbit.rest()
  return spent
}"""

POSED = """(repeats) => {
  const actor = __cutcell.renderer.actors.get("body")
  return Array.from({length: repeats}, () => {
    const begin = performance.now()
    actor.posed()
    return performance.now() - begin
  })
}"""
