"""A comparison on a terminal, however wide that is."""

from __future__ import annotations

from collections.abc import Iterable
from itertools import accumulate

from rich.console import Console, Group, RenderableType
from rich.table import Table
from rich.text import Text

from cutcell.runtime.display import printable, shown_name

from ...metrics import METRICS
from .scores import Comparison, RigScore

HEADLINES = ("l1", "deformation")
"""Metrics that a summary of several rigs shows with mean and best method."""
TAKEN = 5 * 5 + 5 + 7 * 2
"""Columns that the numbers of the headlines and the count of rigs take, with the gaps between."""
NAME = 6
"""Columns that the name of the worst rig needs."""
TURN = 12
"""Columns that the worst turn needs."""


def comparison_table(comparison: Comparison, width: int) -> RenderableType:
    """Lay out a comparison: one rig in full, or several with medians, means and the worst."""
    parts: list[RenderableType] = []
    if len(comparison.rigs) == 1:
        parts.append(_one_rig(comparison.rigs[0], width))
    else:
        parts += [_summary(comparison, width), Text(), _rigs(comparison)]
    failures = comparison.failures()
    if failures:
        parts.append(Text())
    for (method, reason), names in failures.items():
        which = "all rigs" if len(names) == len(comparison.rigs) else ", ".join(names)
        on = "" if len(comparison.rigs) == 1 else f" on {which}"
        heading = printable(f"{method} failed{on}")
        parts.append(Text.assemble((heading, "bold yellow"), f": {printable(reason)}"))
    return Group(*parts)


def print_comparison(comparison: Comparison) -> None:
    """Print a comparison on standard output."""
    console = Console(highlight=False)
    console.print(comparison_table(comparison, console.width))


def _table(title: str, *columns: str) -> Table:
    heading = Text(printable(title), "bold")
    table = Table(title=heading, title_justify="left", box=None)
    table.pad_edge = False
    table.add_column(columns[0], no_wrap=True, min_width=11)
    for name in columns[1:]:
        _add_numbers(table, name)
    return table


def _add_numbers(table: Table, name: str) -> None:
    table.add_column(name, justify="right", no_wrap=True, min_width=max(5, len(name)))


def _fitting(names: Iterable[str], width: int) -> list[str]:
    """Return the first metrics whose columns fit a width."""
    columns = {name: 2 + max(5, len(METRICS[name].title)) for name in names}
    ends = accumulate(columns.values())
    return [name for name, end in zip(columns, ends, strict=True) if end <= width]


def _one_rig(rig: RigScore, width: int) -> Table:
    title = f"{rig.name}: {rig.vertices:,} vertices, {rig.joints} joints with weight"
    method = max([11, *(len(score.method) for score in rig.scores)])
    names = _fitting(METRICS, width - method - 2 - TURN)
    table = _table(title, "method", *(METRICS[name].title for name in names))
    table.add_column("worst turn", no_wrap=True, overflow="ellipsis")
    for score in rig.scores:
        if score.failed:
            table.add_row(score.method, Text("failed", "yellow"))
            continue
        cells = [METRICS[name].text(score.values.get(name)) for name in names]
        worst = score.worst[0] if score.worst else None
        turn = f"{shown_name(worst.name)}, {worst.axis}" if worst else ""
        table.add_row(score.method, *cells, Text(turn))
    return table


def _summary(comparison: Comparison, width: int) -> Table:
    count = len(comparison.rigs)
    title = f"{count} rigs: median and mean of the L1 of weights, and of deformation in cm²"
    table = _table(title, "method", "L1", "mean", "cm²", "mean", "worst")
    # Only the name of a rig may be truncated, to the width that the other columns leave.
    left = width - max([11, *map(len, comparison.methods)]) - TAKEN
    errors = (name for name in METRICS if METRICS[name].lower_is_better and name not in HEADLINES)
    others = _fitting(errors, left - NAME)
    left -= sum(2 + max(5, len(METRICS[name].title)) for name in others)
    table.add_column("on", no_wrap=True, overflow="ellipsis", max_width=max(left, NAME))
    for name in others:
        _add_numbers(table, METRICS[name].title)
    _add_numbers(table, "rigs")
    for method in comparison.methods:
        l1, deformation = (comparison.statistic(method, name) for name in HEADLINES)
        cells: list[str | Text] = [METRICS["l1"].text(value) for value in (l1.median, l1.mean)]
        for value in (deformation.median, deformation.mean, deformation.worst):
            cells.append(METRICS["deformation"].text(value))
        cells.append(Text(shown_name(deformation.worst_rig) if deformation.worst else ""))
        medians = {name: comparison.statistic(method, name).median for name in others}
        cells += [METRICS[name].text(value) for name, value in medians.items()]
        missing = l1.count < count
        share = Text(f"{l1.count}/{count}", "yellow" if missing else "")
        table.add_row(method, *cells, share)
    return table


def _rigs(comparison: Comparison) -> Table:
    """Say for each rig which method is nearest to the artist."""
    table = _table("Best on each rig", "rig", "vertices", "joints", "L1")
    table.add_column("by", no_wrap=True)
    table.add_column("cm²", justify="right", no_wrap=True)
    table.add_column("by", no_wrap=True)
    for rig in comparison.rigs:
        cells: list[str | Text] = [Text(shown_name(rig.name)), f"{rig.vertices:,}", str(rig.joints)]
        for name in HEADLINES:
            values = [
                (score.values[name], score.method)
                for score in rig.scores
                if score.method != "artist" and score.values.get(name) is not None
            ]
            best, by = min(values, default=(None, ""))
            cells += [METRICS[name].text(best), by]
        table.add_row(*cells)
    return table
