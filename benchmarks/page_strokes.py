"""How soon a stroke of the brush is seen, on the whole page of its own server."""

from __future__ import annotations

import tempfile
from pathlib import Path

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
PATIENCE = 1_500_000
"""Milliseconds until the first weights are computed: hundreds of thousands of vertices take some
minutes on a busy machine."""
WAIT = """() => new Promise((done) => {
  const brush = window.__cutcell.brush
  const painted = brush.painted
  brush.painted = function (...given) {
    const arrived = watch.now()
    painted.apply(this, given)
    brush.painted = painted
    requestAnimationFrame(() => setTimeout(() => done([arrived, watch.now()])))
  }
  setTimeout(() => { brush.painted = painted; done(null) }, 20000)
})"""
"""Resolves when colours of a stroke have been drawn: when these arrived, and when it was."""


def strokes_table(browser: Browser, vertices: int, joints: int, moves: int) -> Table:
    """Paint step by step, each step a stroke of its own; time what is seen after each."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder, "capsule.glb")
        rig = painted_character(vertices, joints)
        cutcell.save(path, rig)
        with served(str(path)) as server:
            times_of, used = _painted(browser, server, rig, moves)
    table = Table(
        "A stroke of the brush",
        ["", "median", "95 %"],
        f"{len(rig.mesh.vertices):,} vertices, {len(rig.skeleton.joints)} bones, the whole page at "
        f"1100x720 pixels; {moves} moves of {STEP} pixels. From a pointer's event in the browser, "
        "through the server, to the first frame with other colours.",
    )
    for does, times in zip(("arrive in the browser", "are seen"), times_of.T, strict=True):
        middle, slow = (f"{1000 * value:.0f} ms" for value in np.percentile(times, [50, 95]))
        table.add(f"until other colours {does}", middle, slow)
    for program, seconds in zip(("server", "browser"), used, strict=True):
        table.add(f"processor time of the {program}, mean", f"{1000 * seconds:.0f} ms", "")
    return table


def _painted(
    browser: Browser, server: Server, rig: cutcell.Rig, moves: int
) -> tuple[NDArray, NDArray]:
    """Return seconds of each stroke: until other colours arrive and until they are seen.

    Also returns the mean processor time of the server and of the browser. Shapes (moves, 2), (2,).
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
    box = page.locator("canvas").first.bounding_box()
    assert box is not None
    x, y = box["x"] + box["width"] / 2, box["y"] + box["height"] / 2
    times_of, used = [], []
    for move in range(moves + 2):
        page.mouse.move(x, y)
        page.mouse.down()
        page.wait_for_timeout(300)
        before = _processor_seconds(server)
        page.evaluate(f"void (window.seen = ({WAIT})())")
        page.evaluate("watch.hear('pointermove')")
        page.mouse.move(x + STEP * (1 + move % 7), y + STEP * (1 + move % 5))
        seen_at = page.evaluate("window.seen")
        if seen_at is not None:
            times_of.append(np.array(seen_at) / 1000 - visitor.wait("watch.heard"))
            used.append(_processor_seconds(server) - before)
        page.mouse.up()
        page.wait_for_function("__cutcell.serverIdle()", timeout=PATIENCE)
    page.close()
    # The first ones prepare what the others use.
    return np.array(times_of[2:]), np.mean(used[2:], axis=0)


def _processor_seconds(server: Server) -> NDArray:
    """Return what the server and the browser, which are children of this process, used so far."""
    browsers = [one for one in psutil.Process().children(recursive=True) if "chrom" in one.name()]
    programs = [server.process], browsers
    return np.array([sum(sum(one.cpu_times()[:2]) for one in some) for some in programs])
