"""How soon the colours follow a joint that is dragged, on the whole page of its own server."""

from __future__ import annotations

import tempfile
from dataclasses import replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from playwright.sync_api import Browser

import cutcell
from cutcell_lab.benchmarks.tables import Table

from .page_subjects import character
from .page_visitor import Watched
from .visitors import served

STEP = 3
"""Pixels that the pointer moves at a time."""
WAIT = """() => new Promise((done) => {
  const [view, begin] = [window.__cutcell, performance.now()]
  const receive = view.receive
  view.receive = function (message) {
    const arrived = watch.now()
    receive.call(this, message)
    const {actors} = message
    const body = actors instanceof Map ? actors.get("body") : actors?.body
    if (body?.colors === undefined && body?.scalars === undefined) { return }
    view.receive = receive
    requestAnimationFrame(() => setTimeout(() => done([arrived, watch.now()])))
  }
  setTimeout(() => { view.receive = receive; done(null) }, 5000)
})"""
"""Resolves when the body has been drawn in other colours: when these arrived, and when it was."""


def joints_table(browser: Browser, vertices: int, moves: int) -> Table:
    """Drag a joint step by step; time what is seen after each."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder, "capsule.glb")
        rig = character(vertices)
        cutcell.save(path, replace(rig, weights=cutcell.bind(rig, 16).weights))
        with served(str(path)) as server:
            times_of = _dragged(browser, server.address, rig.skeleton.names[25], moves)
    table = Table(
        "A joint that is dragged",
        ["", "median", "95 %"],
        f"{len(rig.mesh.vertices):,} vertices, {len(rig.skeleton.joints)} bones, R = 64, the whole "
        f"page at 1100x720 pixels; {moves} moves by {STEP} pixels. From the pointer's event in the "
        "browser, through the server, to the first frame with other colours.",
    )
    for does, times in zip(("arrive in the browser", "are seen"), times_of.T, strict=True):
        middle, slow = (f"{1000 * value:.0f} ms" for value in np.percentile(times, [50, 95]))
        table.add(f"until other colours {does}", middle, slow)
    return table


def _dragged(browser: Browser, address: str, joint: str, moves: int) -> NDArray:
    """Return the seconds until other colours arrive and until they are seen, shape (moves, 2)."""
    visitor = Watched(browser, f"{address}/?panel=weights&bone={joint}", 1100, 720)
    page = visitor.page
    page.get_by_text("interior,").first.wait_for(timeout=90_000)
    page.wait_for_timeout(1500)  # the sidebar follows what was bound
    page.get_by_role("switch", name="Show move handle").click()
    page.wait_for_function("__cutcell.jointHandle()")
    page.evaluate("watch.stop()")
    x, y = page.evaluate("__cutcell.jointHandle()")
    page.mouse.move(x, y)
    page.mouse.down()
    times_of = []
    for move in range(moves + 2):
        page.evaluate(f"void (window.seen = ({WAIT})())")
        page.evaluate("watch.hear('pointermove')")
        page.mouse.move(x + STEP * (1 + move % 7), y + STEP * (1 + move % 5))
        seen_at = page.evaluate("window.seen")
        if seen_at is not None:
            times_of.append(np.array(seen_at) / 1000 - visitor.wait("watch.heard"))
        # The exact colours follow when the pointer rests.
        page.wait_for_function("__cutcell.serverIdle()")
        page.wait_for_timeout(300)
    page.mouse.up()
    page.close()
    return np.array(times_of[2:])  # the first ones prepare what the others use
