"""How soon the Weights panel shows another falloff, on the whole page of its own server."""

from __future__ import annotations

import tempfile
from dataclasses import replace
from pathlib import Path

from playwright.sync_api import Browser

import cutcell
from cutcell_lab.benchmarks.tables import Table

from .page_subjects import character
from .page_visitor import Watched
from .timing import Times
from .visitors import served

START = "?panel=weights&falloff=paper&alpha=0.2"
MOST = "Max influences"
SLIDERS = {
    "smoothness α": ("Smoothness α", "mix"),
    "most influences": (MOST, "count"),
    "threshold": ("Ignore weights below", "count"),
}
"""The slider that is moved by ten steps, or one, and what the colours show meanwhile."""


def weights_table(browser: Browser, vertices: int, rounds: int) -> Table:
    """Move the sliders of the panel Weights by keys, in turn; time what is seen."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder, "capsule.glb")
        rig = character(vertices)
        cutcell.save(path, replace(rig, weights=cutcell.bind(rig, 16).weights))
        with served(str(path)) as server:
            times_of = {
                what: _moved(browser, server.address, slider, colours, rounds)
                for what, (slider, colours) in SLIDERS.items()
            }
    table = Table(
        "Another falloff",
        ["", "until it is seen", "slowest"],
        f"{len(rig.mesh.vertices):,} vertices, {len(rig.skeleton.joints)} bones, the whole page "
        "at 1100x720 pixels. From the key's event in the browser, through the server, to changed "
        "pixels: medians, the range in brackets.",
    )
    for what, times in times_of.items():
        table.add(what, Times(tuple(times)), f"{1000 * max(times):.0f} ms")
    return table


def _moved(browser: Browser, address: str, slider: str, colours: str, rounds: int) -> list[float]:
    visitor = Watched(browser, f"{address}/{START}&weights_shown={colours}", 1100, 720)
    page = visitor.page
    page.get_by_text("interior,").first.wait_for(timeout=90_000)
    page.wait_for_timeout(1500)  # the sidebar follows what was bound
    page.get_by_role("button", name="Falloff").click()
    thumb = page.get_by_role("slider", name=slider)
    key = "ArrowLeft" if slider == MOST else "Shift+ArrowRight"
    back = "ArrowRight" if slider == MOST else "Shift+ArrowLeft"

    def seconds_of(key: str) -> float:
        thumb.focus()
        return visitor.seen_after_key(key)

    seconds_of(key)  # not counted: the first one draws what was not drawn before
    times_of = [seconds_of((back, key)[turn % 2]) for turn in range(rounds)]
    page.close()
    return times_of
