"""A comparison on a terminal, however wide that is."""

from __future__ import annotations

from rich.console import Console, Group, RenderableType
from rich.table import Table
from rich.text import Text

from cutcell.runtime.display import printable, shown_name

from .markdown import text
from .scores import Comparison, RigScore

ROOMY = 100
"""Columns of a terminal from which on all measures are shown."""
FIELDS = ("l1", "deformation", "clips", "crosstalk", "seconds")
NUMBERS, ROOMY_NUMBERS = 5 * 5 + 7 + 5 + 8 * 2, 8 + 9 + 2 * 2 + 1
"""Columns that the summary's numbers take, with the gaps between."""


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


def _one_rig(rig: RigScore, width: int) -> Table:
    title = f"{rig.name}: {rig.vertices:,} vertices, {rig.joints} joints with weight"
    names = ["l1", "precision", "recall", "deformation", "seconds"]
    heads = ["L1", "precision", "recall", "cm²", "seconds"]
    if width >= ROOMY:
        names[4:4], heads[4:4] = ["clips", "crosstalk"], ["clips cm²", "crosstalk"]
    table = _table(title, "method", *heads)
    table.add_column("worst turn", no_wrap=True, overflow="ellipsis")
    for score in rig.scores:
        if score.failed:
            table.add_row(score.method, Text("failed", "yellow"))
            continue
        cells = [text(getattr(score, name), name) for name in names]
        worst = score.worst[0] if score.worst else None
        turn = f"{shown_name(worst.name)}, {worst.axis}" if worst else ""
        table.add_row(score.method, *cells, Text(turn))
    return table


def _summary(comparison: Comparison, width: int) -> Table:
    count = len(comparison.rigs)
    title = f"{count} rigs: median and mean of the L1 of weights, and of deformation in cm²"
    table = _table(title, "method", "L1", "mean", "cm²", "mean", "worst")
    # Only the name of a rig may be truncated, to the width that the other columns leave.
    others = max(map(len, comparison.methods)) + NUMBERS + (ROOMY_NUMBERS if width >= ROOMY else 0)
    table.add_column("on", no_wrap=True, overflow="ellipsis", max_width=max(width - others, 6))
    for name in ("clips cm²", "crosstalk") if width >= ROOMY else ():
        _add_numbers(table, name)
    for name in ("seconds", "rigs"):
        _add_numbers(table, name)
    for method in comparison.methods:
        statistics = {name: comparison.statistic(method, name) for name in FIELDS}
        l1, deformation = statistics["l1"], statistics["deformation"]
        cells: list[str | Text] = [text(l1.median, "l1"), text(l1.mean, "l1")]
        for value in (deformation.median, deformation.mean, deformation.worst):
            cells.append(text(value, "deformation"))
        cells.append(Text(shown_name(deformation.worst_rig) if deformation.worst else ""))
        if width >= ROOMY:
            cells += [text(statistics[name].median, name) for name in ("clips", "crosstalk")]
        cells.append(text(statistics["seconds"].median, "seconds"))
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
        for name in ("l1", "deformation"):
            values = [
                (getattr(score, name), score.method)
                for score in rig.scores
                if score.method != "artist" and getattr(score, name) is not None
            ]
            best, by = min(values, default=(None, ""))
            cells += [text(best, name), by]
        table.add_row(*cells)
    return table
