"""How soon a stroke of the brush is seen, on the whole page of its own server."""

from __future__ import annotations

import tempfile
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import psutil
from numpy.typing import NDArray
from playwright.sync_api import Browser

import cutcell
from cutcell_lab.benchmarks.tables import Table

from .layers import painted_character
from .page_visitor import Watched
from .visitors import Server, served

STEP = 4
"""Pixels that the pointer moves at a time."""
WARMING = 2
"""Strokes before those that are counted: they prepare what the others use."""
PAUSE = 1000
"""Milliseconds before each event, in which a slow machine draws the last picture in full."""
PATIENCE = 1_500_000
"""Milliseconds until the first weights are computed: hundreds of thousands of vertices take some
minutes on a busy machine."""
WATCH = """() => {
  const view = window.__cutcell
  const gl = view.renderer.context
  const [draw, changed] = [view.draw, view.changed]
  window.picture = {last: 0, count: 0}
  let stale = false
  view.changed = function () { stale = true; changed.call(this) }
  view.draw = function (...given) {
    draw.apply(this, given)
    if (!stale) { return }
    stale = false
    gl.readPixels(0, 0, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, new Uint8Array(4))  // waits for it
    window.picture.last = watch.now()
    window.picture.count += 1
  }
}"""
"""From now on, notes when the last picture that something asked for was finished."""
DRAWN = "window.picture.count > {}"


def strokes_table(browser: Browser, vertices: int, joints: int, strokes: int) -> Table:
    """Paint single strokes and undo them; time until each is seen, and until all has followed."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder, "capsule.glb")
        rig = painted_character(vertices, joints)
        cutcell.save(path, rig)
        with served(str(path)) as server:
            times_of, used = _painted(browser, server, rig, strokes)
    table = Table(
        "A stroke of the brush",
        ["", "median", "95 %", "redraws"],
        f"{len(rig.mesh.vertices):,} vertices, {len(rig.skeleton.joints)} bones, the whole page at "
        f"1100x720 pixels; {strokes} strokes of {STEP} pixels or more. From the event in the "
        "browser, through the server, to the finished picture, and as a ratio to a redraw of the "
        "same scene. Drawn in software.",
    )
    redraw = float(np.median(times_of["the same scene is drawn again"]))
    for does, times in times_of.items():
        middle, slow = np.percentile(times, [50, 95])
        form = "{:.0f} ms".format
        table.add(f"until {does}", form(1000 * middle), form(1000 * slow), f"{middle / redraw:.1f}")
    for program, seconds in zip(("server", "browser"), used, strict=True):
        name = f"processor time of the {program} for a stroke, mean"
        table.add(name, f"{1000 * seconds:.0f} ms", "", "")
    return table


def _painted(
    browser: Browser, server: Server, rig: cutcell.Rig, strokes: int
) -> tuple[dict[str, list[float]], NDArray]:
    """Return seconds by what they pass until, and the mean processor time of a stroke.

    The latter is that of the server and of the browser, shape (2,).
    """
    joint, length = rig.skeleton.names[len(rig.skeleton.names) // 2], rig.mesh.vertices.size
    query = f"?panel=weights&resolution=24&bone={joint}"
    visitor = Watched(browser, f"{server.address}/{query}", 1100, 720)
    page = visitor.page
    is_open = f"__cutcell.renderer.actors.get('body')?.rest?.length === {length}"
    page.wait_for_function(is_open, timeout=PATIENCE)  # a demo is shown before
    page.keyboard.press("b")
    page.wait_for_function("__cutcell.brush.part", timeout=PATIENCE)  # weights are computed
    page.wait_for_function("__cutcell.serverIdle()", timeout=PATIENCE)
    page.evaluate("watch.stop()")
    page.evaluate(WATCH)
    times_of: dict[str, list[float]] = {}

    def timed(does: str, event: str, act: Callable[[], Any], until_idle: str = "") -> None:
        """Note the time until a picture; with `until_idle`, until the last one, and after that."""
        page.wait_for_timeout(PAUSE)
        count = page.evaluate("window.picture.count")
        page.evaluate(f"watch.hear('{event}')")
        act()
        if until_idle:
            page.wait_for_function("__cutcell.serverIdle()", timeout=PATIENCE)
            idle = page.evaluate("watch.now()") / 1000 - visitor.wait("watch.heard")
            times_of.setdefault(until_idle, []).append(idle)
        else:
            page.wait_for_function(DRAWN.format(count), timeout=PATIENCE)
        if page.evaluate(DRAWN.format(count)):
            seen = page.evaluate("window.picture.last") / 1000 - visitor.wait("watch.heard")
            times_of.setdefault(does, []).append(seen)

    box = page.locator("canvas").first.bounding_box()
    assert box is not None
    x, y = box["x"] + box["width"] / 2, box["y"] + box["height"] / 2
    again = "dispatchEvent(new Event('redraw')); __cutcell.changed()"
    used: list[NDArray] = []
    for stroke in range(WARMING + strokes):
        if stroke == WARMING:
            times_of.clear()
            used.clear()
        timed("the same scene is drawn again", "redraw", lambda: page.evaluate(again))
        before = _processor_seconds(server)
        page.mouse.move(x, y)
        page.mouse.down()
        to = x + STEP * (1 + stroke % 7), y + STEP * (1 + stroke % 5)
        timed("a stroke is seen", "pointermove", partial(page.mouse.move, *to))
        timed("a stroke settles", "pointerup", page.mouse.up, "all numbers follow a stroke")
        used.append(_processor_seconds(server) - before)
    for _ in range(strokes):
        undo = partial(page.keyboard.press, "Control+z")
        timed("undo settles", "keydown", undo, "all numbers follow undo")
    page.close()
    return times_of, np.mean(used, axis=0)


def _processor_seconds(server: Server) -> NDArray:
    """Return what the server and the browser, which are children of this process, used so far."""
    browsers = [one for one in psutil.Process().children(recursive=True) if "chrom" in one.name()]
    programs = [server.process], browsers
    return np.array([sum(sum(one.cpu_times()[:2]) for one in some) for some in programs])
