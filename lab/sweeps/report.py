"""A sweep as a table on a terminal."""

from __future__ import annotations

from rich.console import Console
from rich.table import Table
from rich.text import Text

from cutcell.runtime.display import printable

from .run import MEASURES, Sweep, value_text

REFERENCES = {"file": "the file's weights", "computed": "the weights of the method without it"}
"""Titles of the weights that errors are measured against."""


def print_sweep(sweep: Sweep) -> None:
    """Print a sweep on standard output."""
    title = printable(f"{sweep.rig}: {sweep.option}, against {REFERENCES[sweep.reference]}")
    table = Table(title=Text(title, "bold"), title_justify="left", box=None, pad_edge=False)
    table.add_column(sweep.option, no_wrap=True)
    for metric in MEASURES.values():
        name = metric.title
        table.add_column(name, justify="right", no_wrap=True, min_width=len(name))
    for point in sweep.points:
        cells = [metric.text(getattr(point, name)) for name, metric in MEASURES.items()]
        if point.failed:
            cells[0] = "failed"
        table.add_row(value_text(point.value), *cells)
    console = Console(highlight=False)
    console.print(table)
    for point in sweep.points:
        if point.failed:
            line = f"{sweep.option}={value_text(point.value)}: {point.failed}"
            console.print(Text(printable(line), "yellow"))
