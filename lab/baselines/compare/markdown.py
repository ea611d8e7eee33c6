"""A comparison as Markdown."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from cutcell.runtime.display import printable

from .scores import MEASURES, Comparison, MethodScore


def comparison_markdown(comparison: Comparison) -> str:
    """Write a comparison as Markdown: the summary, then one table for each measure.

    Parameters
    ----------
    comparison : Comparison

    Returns
    -------
    str
        Ends with a line break. Failures are named below the tables.
    """
    measures = ("l1", "precision", "recall", "deformation", "clips", "crosstalk", "seconds")
    lines = ["## All rigs: median, mean (rigs)", ""]
    lines += markdown_table(
        ["method", *(MEASURES[name] for name in measures), "no weight", "worst deformation"],
        [_summary_row(comparison, method, measures) for method in comparison.methods],
    )
    for name in ("l1", "deformation", "clips", "crosstalk", "seconds"):
        rows = [
            [rig.name, *(_cell(score, name) for score in rig.scores)] for rig in comparison.rigs
        ]
        lines += ["", f"## {MEASURES[name]}", ""]
        lines += markdown_table(["rig", *comparison.methods], rows)
    failures = comparison.failures()
    if failures:
        lines += ["", "## Failed", ""]
        lines += [
            printable(f"- {method} on {', '.join(rigs)}: {reason}")
            for (method, reason), rigs in failures.items()
        ]
    return "\n".join(lines) + "\n"


def _summary_row(comparison: Comparison, method: str, measures: Sequence[str]) -> list[str]:
    cells = []
    for name in measures:
        statistic = comparison.statistic(method, name)
        cells.append(
            f"{text(statistic.median, name)}, {text(statistic.mean, name)} ({statistic.count})"
        )
    none = comparison.statistic(method, "unweighted").mean
    worst = comparison.statistic(method, "deformation")
    cells.append("–" if none is None else f"{none:.1%}")
    cells.append(f"{text(worst.worst, 'deformation')} {worst.worst_rig}".strip())
    return [method, *cells]


def _cell(score: MethodScore, measure: str) -> str:
    value = getattr(score, measure)
    return "failed" if score.failed and value is None else text(value, measure)


def text(value: float | None, measure: str) -> str:
    """Write a number with as many digits as its measure deserves."""
    if value is None:
        return "–"
    digits = {"deformation": 1, "clips": 1, "seconds": 2}.get(measure, 3)
    return f"{value:.{digits}f}"


def markdown_table(head: Sequence[str], rows: Iterable[Sequence[str]]) -> list[str]:
    """Return the lines of a table; the first column is text, the others are numbers."""
    align = ["---", *["---:"] * (len(head) - 1)]
    return ["| " + " | ".join(map(_cell_text, row)) + " |" for row in (head, align, *rows)]


def _cell_text(text: str) -> str:
    return printable(text).replace("|", "\\|")
