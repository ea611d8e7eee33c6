"""An evaluation as tables, on a terminal or in Markdown."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import chain

from rich.console import Console
from rich.table import Table
from rich.text import Text

from cutcell.runtime.display import printable

from ..baselines.compare.markdown import markdown_table
from ..metrics import DEFINITIONS
from .scores import Evaluation


def evaluation_markdown(evaluation: Evaluation) -> str:
    """Write an evaluation as Markdown: a table for each definition, then what is left out.

    Parameters
    ----------
    evaluation : Evaluation

    Returns
    -------
    str
        Ends with a line break.
    """
    lines: list[str] = []
    for name, definition in DEFINITIONS.items():
        lines += [f"## {definition.title}", "", definition.text, ""]
        lines += markdown_table(_head(name), chain(_rigs(evaluation, name), _all(evaluation, name)))
        lines.append("")
    left_out = list(left_out_lines(evaluation))
    if left_out:
        lines += ["## Left out", "", *(printable(f"- {line}") for line in left_out), ""]
    return "\n".join(lines)


def print_evaluation(evaluation: Evaluation) -> None:
    """Print a table for each definition on standard output."""
    console = Console(highlight=False)
    for index, (name, definition) in enumerate(DEFINITIONS.items()):
        if index:
            console.print()
        console.print(Text(definition.title, "bold"))
        console.print(Text(definition.text, "dim"))
        table = Table(box=None, pad_edge=False)
        rig, *numbers = _head(name)
        table.add_column(rig, no_wrap=True, min_width=11, overflow="ellipsis")
        for heading in numbers:
            table.add_column(heading, justify="right", no_wrap=True, min_width=len(heading))
        for row in _rigs(evaluation, name):
            table.add_row(*(Text(printable(cell)) for cell in row))
        for row in _all(evaluation, name):
            table.add_row(*row, style="bold")
        console.print(table)


def left_out_lines(evaluation: Evaluation) -> Iterator[str]:
    """Name what was not evaluated, and say why."""
    for name in evaluation.predicted_only:
        yield f"{name}: there is no reference of this name"
    for name in evaluation.reference_only:
        yield f"{name}: there is no prediction of this name"
    for name, reason in evaluation.failed.items():
        yield f"{name}: {reason}"


def _head(name: str) -> list[str]:
    return ["rig", *(metric.title for metric in DEFINITIONS[name].measures.values())]


def _rigs(evaluation: Evaluation, name: str) -> Iterator[list[str]]:
    measures = DEFINITIONS[name].measures
    for rig in evaluation.rigs:
        yield [rig.name, *(of.text(rig.errors[name][key]) for key, of in measures.items())]


def _all(evaluation: Evaluation, name: str) -> Iterator[list[str]]:
    """Return the rows of the median and the mean, if there are several rigs."""
    if len(evaluation.rigs) > 1:
        measures = DEFINITIONS[name].measures
        statistics = {key: evaluation.statistic(name, key) for key in measures}
        for row in ("median", "mean"):
            yield [row, *(of.text(statistics[key][row]) for key, of in measures.items())]
