"""The comparison of networks as tables: each head with each prior, beside the paper."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .network_scores import PART, Scores, groups, means
from .tables import Table

MEASURES = ("L1", "precision", "recall", "cm²")
PAPER = {
    "rignet": ("voxel", (0.432, 0.367), (8.58, 6.06)),
    "unirig": ("voxel_unirig", (0.747, 0.386), (21.25, 10.91)),
    "puppeteer": ("none", (0.335, 0.320), (5.949, 5.333)),
}
"""Of each head what the paper has as base, and its L1 and deformation error before and after; of
RigNet on ModelsResource, of the others on Articulation-XL 2.0."""

Results = dict[tuple[str, str], list[Scores]]
"""By head and prior: the scores of each seed."""


@dataclass(frozen=True)
class Comparison:
    """Results of all runs.

    Parameters
    ----------
    results : Results
    alone : dict of str to Scores
        By prior, of the prior itself.
    runs : int
    seconds : float
        CPU seconds of all trainings.
    """

    results: Results
    alone: dict[str, Scores]
    runs: int
    seconds: float


def tables(comparison: Comparison) -> list[Table]:
    """Return all tables."""
    results, alone = comparison.results, comparison.alone
    return [
        paper_table(results),
        *(head_table(results, alone, which, False) for which in ("other makers", "same maker")),
        head_table(results, alone, "other makers", True),
    ]


def head_table(results: Results, alone: dict[str, Scores], which: str, after: bool) -> Table:
    """List each head with each prior: the four measures over the characters of a group."""
    at = slice(4, 8) if after else slice(0, 4)
    names = groups(next(iter(alone.values())))[which]
    title = f"On {len(names)} characters by {'other makers' if which[0] == 'o' else 'the same'}"
    note = "Means over the characters; mean over the seeds ± standard deviation."
    if after:
        title += ", small weights dropped"
        note += f" Weights below {PART:.0%} of a point's largest are dropped, as in evaluations."
    columns = ["head", "prior", "seeds", "L1", "L1 median", "L1 worst", *MEASURES[1:]]
    table = Table(title, columns, note)

    def add(head: str, prior: str, scores: Sequence[Scores]) -> None:
        each = np.array([means(one, names, at) for one in scores])
        l1 = np.array([[one[name][at][0] for name in names] for one in scores])
        cells = [each[:, 0], np.median(l1, axis=1), l1.max(axis=1), each[:, 1], each[:, 2]]
        if len(scores) == 1:
            cells = [f"{v[0]:.3f}" for v in cells] + [f"{each[0, 3]:.2f}"]
        else:
            cells = [spread(v, 3) for v in cells] + [spread(each[:, 3], 2)]
        table.add(head, prior, "-" if head[0] == "(" else len(scores), *cells)

    for prior, scores in alone.items():
        add("(the prior alone)", prior, [scores])
    for (head, prior), runs in results.items():
        add(head, prior, runs)
    return table


def paper_table(results: Results) -> Table:
    """Put what the paper's prior changes beside what the paper says."""
    note = (
        "Changes by the paper's prior (cutcell) from each head's earlier prior, on characters "
        "by other makers. `better`: in how many seeds."
    )
    columns = ["head", "before", "L1 here", "better", "cm² here", "better", "paper L1", "paper cm²"]
    table = Table("Beside the paper", columns, note)
    for head, (base, l1, moved) in PAPER.items():
        before, after = results.get((head, base)), results.get((head, "cutcell"))
        if not before or not after:
            continue
        names = groups(before[0])["other makers"]
        count = min(len(before), len(after))
        before, after = before[:count], after[:count]
        one = np.array([means(scores, names)[[0, 3]] for scores in before])
        other = np.array([means(scores, names)[[0, 3]] for scores in after])
        better = (other < one).sum(axis=0)
        change = other.mean(axis=0) / one.mean(axis=0) - 1
        table.add(
            head,
            base,
            f"{change[0]:+.1%}",
            f"{better[0]} of {count}",
            f"{change[1]:+.1%}",
            f"{better[1]} of {count}",
            f"{l1[1] / l1[0] - 1:+.1%}",
            f"{moved[1] / moved[0] - 1:+.1%}",
        )
    return table


def spread(values: NDArray, digits: int) -> str:
    """Format the mean over seeds and their standard deviation."""
    deviation = values.std(ddof=1) if len(values) > 1 else 0.0
    return f"{values.mean():.{digits}f} ± {deviation:.{digits}f}"
