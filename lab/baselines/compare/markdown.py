"""A comparison as Markdown."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from cutcell.runtime.display import printable

from ...metrics import METRICS
from .scores import Comparison, MethodScore


def comparison_markdown(comparison: Comparison) -> str:
    """Write a comparison as Markdown: the summary, then one table for each error.

    Parameters
    ----------
    comparison : Comparison

    Returns
    -------
    str
        Ends with a line break. Failures are named below the tables.
    """
    lines = ["## All rigs: median, mean (rigs)", ""]
    heads = [metric.title for metric in METRICS.values()]
    rows = [_summary_row(comparison, method) for method in comparison.methods]
    lines += markdown_table(["method", *heads, "worst deformation"], rows)
    for name, metric in METRICS.items():
        if metric.lower_is_better:
            rows = [
                [rig.name, *(_cell(score, name) for score in rig.scores)] for rig in comparison.rigs
            ]
            lines += ["", f"## {metric.title}", ""]
            lines += markdown_table(["rig", *comparison.methods], rows)
    failures = comparison.failures()
    if failures:
        lines += ["", "## Failed", ""]
        lines += [
            printable(f"- {method} on {', '.join(rigs)}: {reason}")
            for (method, reason), rigs in failures.items()
        ]
    return "\n".join(lines) + "\n"


def _summary_row(comparison: Comparison, method: str) -> list[str]:
    cells = []
    for name, metric in METRICS.items():
        one = comparison.statistic(method, name)
        cells.append(f"{metric.text(one.median)}, {metric.text(one.mean)} ({one.count})")
    worst = comparison.statistic(method, "deformation")
    cells.append(f"{METRICS['deformation'].text(worst.worst)} {worst.worst_rig}".strip())
    return [method, *cells]


def _cell(score: MethodScore, name: str) -> str:
    value = score.values.get(name)
    return "failed" if score.failed and value is None else METRICS[name].text(value)


def markdown_table(head: Sequence[str], rows: Iterable[Sequence[str]]) -> list[str]:
    """Return the lines of a table; the first column is text, the others are numbers."""
    align = ["---", *["---:"] * (len(head) - 1)]
    return ["| " + " | ".join(map(_cell_text, row)) + " |" for row in (head, align, *rows)]


def _cell_text(text: str) -> str:
    return printable(text).replace("|", "\\|")
