"""How soon the page shows things, beside Panel's own VTK pane on the same scene.

python -m benchmarks.page [--rounds 3] [--write]

Both stand on bare pages of one server, in one headless Chromium that draws in software. A
watch in the browser samples the canvas at every frame: what is timed ends when pixels differ.
`--write` puts the tables into docs/page-speed.md.
"""

from __future__ import annotations

import argparse
from collections.abc import Iterator, Sequence

import numpy as np
from playwright.sync_api import Browser, sync_playwright

from cutcell_lab.benchmarks.document import PAGE_SPEED, fill
from cutcell_lab.benchmarks.tables import Table, ratio, seconds
from scripts.get_chromium import FLAGS, find

from .page_joints import joints_table
from .page_strokes import strokes_table
from .page_subjects import SIZE, Material, cutcell_subject, material, vtk_subject
from .page_visitor import Visitor, served
from .page_weights import weights_table
from .report import circumstances
from .timing import Times

OURS, PEER = "cutcell", "pn.pane.VTK"

Taken = dict[str, dict[str, list[float]]]


def tables(options: argparse.Namespace) -> Iterator[Table]:
    """Measure; give each table when it is there."""
    chromium = find()
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=chromium, args=list(FLAGS))
        if options.only is None:
            yield from _side_by_side(browser, options)
            yield weights_table(browser, options.vertices, options.weights)
        if options.only != "strokes":
            yield joints_table(browser, options.vertices, options.joints)
        if options.only != "joints":
            yield strokes_table(browser, *options.large, options.strokes)
        browser.close()


def _side_by_side(browser: Browser, options: argparse.Namespace) -> list[Table]:
    scene = material(options.resolution, options.vertices)
    subjects = {OURS: cutcell_subject(scene), PEER: vtk_subject(scene)}
    times_of: Taken = {}
    moves: dict[str, list[float]] = {}
    with served(list(subjects.values()), options.port) as url:
        for _ in range(options.rounds):
            for name, subject in subjects.items():
                visitor = Visitor(browser, url, subject)
                _changes(visitor, name, options.changes, times_of)
                _moves(visitor, name, options.play, moves)
                visitor.page.close()
    return [_sooner(scene, times_of), _moving(moves)]


def _changes(visitor: Visitor, name: str, changes: int, times_of: Taken) -> None:
    """Time everything that is compared, first without the graph, then with it."""

    def note(what: str, value: float) -> None:
        times_of.setdefault(what, {}).setdefault(name, []).append(value)

    subject = visitor.subject
    ways = {"new scalars": subject.color, "new points": subject.move, "a new pose": subject.pose}
    note("first picture", visitor.first_picture)
    turn = 0
    for suffix, repeats in (("", changes), (", graph shown", 1)):
        if suffix:
            note("graph shown", visitor.seen_after(lambda: subject.show_graph(True)))
        for what, change in ways.items():
            for _ in range(repeats):
                turn += 1
                note(what + suffix, visitor.seen_after(lambda c=change, t=turn: c(t)))


def _moves(visitor: Visitor, name: str, play: float, moves: dict[str, list[float]]) -> None:
    """Time frames while the view turns and, in ours, while a motion plays; the graph is shown."""

    def note(what: str, *values: float) -> None:
        moves.setdefault(f"{name}: {what}", []).extend(values)

    note("between frames of a drag, graph shown", *visitor.orbit())
    if name != OURS:
        return
    for whole, drawn in ((False, "what is drawn while moving"), (True, "everything")):
        note(f"a turn, graph shown, {drawn}", *visitor.turns(whole))
    for suffix in (", graph shown", ""):
        if not suffix:
            visitor.seen_after(lambda: visitor.subject.show_graph(False))
        script, frame = visitor.play(play)
        note(f"script a frame while playing{suffix}", script)
        note(f"a frame while playing{suffix}", frame)
    note("script a pose without the graphics card", *visitor.on_processor())


def _sooner(scene: Material, times_of: Taken) -> Table:
    table = Table(
        "Until it is seen",
        ["", OURS, PEER, "speed-up"],
        f"{scene.size}; {SIZE[0]}x{SIZE[1]} pixels. From the change in Python, or from asking "
        "for the address, to changed pixels: medians, the range in brackets, in turn.",
    )
    for what, by in times_of.items():
        one, other = Times(tuple(by[OURS])), Times(tuple(by[PEER]))
        table.add(what, one, other, ratio(other.median / one.median))
    return table


def _moving(moves: dict[str, list[float]]) -> Table:
    table = Table(
        "While things move",
        ["", "median", "90th percentile"],
        "Drawn in software: with a graphics card most of a frame's time is saved. A turn lasts "
        "until its picture is finished.",
    )
    for what, values in sorted(moves.items()):
        table.add(what, seconds(float(np.median(values))), seconds(float(np.quantile(values, 0.9))))
    return table


def arguments(argv: Sequence[str] | None = None) -> argparse.Namespace:
    """Read the command line."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.page", description=__doc__)
    parser.add_argument("--rounds", type=int, default=3)
    parser.add_argument("--changes", type=int, default=2, help="of each kind, every round")
    parser.add_argument("--weights", type=int, default=10, help="moves of each slider")
    parser.add_argument("--joints", type=int, default=40, help="moves of a joint that is dragged")
    parser.add_argument("--strokes", type=int, default=20, help="of the brush")
    parser.add_argument(
        "--large",
        type=int,
        nargs=2,
        default=(200_000, 200),
        help="vertices and joints of the character that is painted",
    )
    parser.add_argument("--only", choices=["joints", "strokes"], help="measure nothing else")
    parser.add_argument("--play", type=float, default=4.0, help="seconds of motion")
    parser.add_argument("--resolution", type=int, default=72)
    parser.add_argument("--vertices", type=int, default=20000)
    parser.add_argument("--port", type=int, default=5131)
    parser.add_argument("--write", action="store_true", help="into docs/page-speed.md")
    return parser.parse_args(argv)


def main(argv: Sequence[str] | None = None) -> None:
    """Print the tables."""
    options = arguments(argv)
    texts = [circumstances()]
    print(texts[0], flush=True)
    for table in tables(options):
        texts.append(table.markdown())
        print("", texts[-1], sep="\n", flush=True)
    if options.write:
        fill(PAGE_SPEED, {options.only or "page": "\n\n".join(texts)})


if __name__ == "__main__":
    main()
