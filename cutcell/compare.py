"""Several methods on several rigs, measured against the artists' weights."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import asdict, dataclass
from functools import partial
from inspect import signature
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .baselines import METHODS, BaselineBinding, Method
from .checks import check_choice
from .errors import CutcellError, ParameterError, WeightsError
from .graph import build_graph
from .metrics import (
    Turn,
    clip_error,
    crosstalk,
    deformation_error,
    find_gaps,
    precision_recall,
    unweighted,
    vertex_shares,
    weight_l1,
)
from .progress import Progress, silent
from .rig import Rig

GAP_RESOLUTION = 64
"""Of the graph that tells which parts are far from each other through the body."""


@dataclass(frozen=True)
class MethodScore:
    """What one method makes of one rig. None: it failed, or there is nothing to measure.

    Parameters
    ----------
    method : str
    failed : str
        Why there are no weights; empty where there are.
    l1, precision, recall
        Of the weights; see `cutcell.metrics`.
    deformation : float
        cm², every joint turned by 30°.
    clips : float
        The same over the file's own clips, their mean.
    unweighted : float
        Share of the surface's places without weight.
    crosstalk : float
        Weight shared across gaps.
    seconds : float
        All stages together.
    warnings : tuple of str
    worst : tuple of Turn
        The joints and axes with the greatest error.
    """

    method: str
    failed: str = ""
    l1: float | None = None
    precision: float | None = None
    recall: float | None = None
    deformation: float | None = None
    clips: float | None = None
    unweighted: float | None = None
    crosstalk: float | None = None
    seconds: float | None = None
    warnings: tuple[str, ...] = ()
    worst: tuple[Turn, ...] = ()


@dataclass(frozen=True)
class RigScore:
    """What all methods make of one rig.

    Parameters
    ----------
    name : str
    vertices, joints, clips : int
        Vertices of the file; joints that carry weight; clips.
    gaps : int
        Pairs of vertices that face each other across a gap.
    scores : tuple of MethodScore
    """

    name: str
    vertices: int
    joints: int
    clips: int
    gaps: int
    scores: tuple[MethodScore, ...]


@dataclass(frozen=True)
class Statistic:
    """One measure of one method over the rigs that have it.

    Parameters
    ----------
    count : int
        Rigs.
    median, mean, worst : float or None
        None where there is no rig.
    worst_rig : str
    """

    count: int
    median: float | None
    mean: float | None
    worst: float | None
    worst_rig: str


@dataclass(frozen=True)
class Comparison:
    """All rigs, and what they come to.

    Parameters
    ----------
    rigs : tuple of RigScore
    methods : tuple of str
    """

    rigs: tuple[RigScore, ...]
    methods: tuple[str, ...]

    def statistic(self, method: str, measure: str) -> Statistic:
        """Sum up a measure, a field of `MethodScore`, over the rigs where a method has it.

        The worst is the lowest precision and recall, and the highest of all else.
        """
        index = self.methods.index(method)
        found = [(getattr(rig.scores[index], measure), rig.name) for rig in self.rigs]
        values = [(value, name) for value, name in found if value is not None]
        if not values:
            return Statistic(0, None, None, None, "")
        pick = min if measure in ("precision", "recall") else max
        worst, name = pick(values, key=lambda pair: pair[0])
        numbers = [value for value, _ in values]
        return Statistic(
            len(values), float(np.median(numbers)), float(np.mean(numbers)), worst, name
        )

    def to_dict(self) -> dict[str, Any]:
        """Return all of it as plain lists, dicts and numbers, for JSON."""
        return {
            "methods": list(self.methods),
            "summary": {
                method: {name: asdict(self.statistic(method, name)) for name in MEASURES}
                for method in self.methods
            },
            "rigs": [asdict(rig) for rig in self.rigs],
        }


MEASURES = {
    "l1": "L1",
    "precision": "precision",
    "recall": "recall",
    "deformation": "deformation cm²",
    "clips": "own clips cm²",
    "unweighted": "no weight",
    "crosstalk": "crosstalk",
    "seconds": "seconds",
}
"""The measures, fields of `MethodScore`, and what tables call them."""


def compare(
    rigs: Iterable[Rig],
    methods: Sequence[str] | Mapping[str, Method] | None = None,
    *,
    resolution: int = 64,
    max_influences: int | None = None,
    progress: Progress = silent,
) -> Comparison:
    """Bind every rig by every method and measure all against the rigs' own weights.

    Parameters
    ----------
    rigs : iterable of Rig
        Each with the weights of its artist; may load them one by one.
    methods : sequence of str, or mapping of names to methods, optional
        Names in `cutcell.baselines.METHODS`, or methods of one's own; all of the former
        when left out.
    resolution : int
        R, for the methods that have a lattice.
    max_influences : int or None
        Joints a vertex may follow; None for no limit.
    progress : callable
        See `cutcell.progress`; each rig is a stage.

    Returns
    -------
    Comparison

    Raises
    ------
    ParameterError
        An unknown method, a parameter out of range, or no rigs.
    WeightsError
        A rig without weights.
    """
    chosen = _chosen(methods, {"resolution": resolution, "max_influences": max_influences})
    scores = [_compare_rig(rig, chosen, progress) for rig in rigs]
    if not scores:
        raise ParameterError("there are no rigs to compare methods on")
    return Comparison(tuple(scores), tuple(chosen))


def _chosen(
    methods: Sequence[str] | Mapping[str, Method] | None, options: Mapping[str, Any]
) -> dict[str, Method]:
    """Look methods up, and give each those options that it knows."""
    if methods is None:
        methods = METHODS
    if not isinstance(methods, Mapping):
        methods = {name: METHODS[check_choice("method", name, METHODS)] for name in methods}
    if not methods:
        raise ParameterError("there are no methods to compare")
    chosen: dict[str, Method] = {}
    for name, method in methods.items():
        known = signature(method).parameters
        every = any(p.kind is p.VAR_KEYWORD for p in known.values())
        chosen[name] = partial(
            method, **{key: value for key, value in options.items() if every or key in known}
        )
    return chosen


def _compare_rig(rig: Rig, methods: Mapping[str, Method], progress: Progress) -> RigScore:
    if rig.weights is None:
        raise WeightsError(f'rig "{rig.name}" has no weights of its own to compare with')
    progress(rig.name, 0.0)
    gaps = find_gaps(build_graph(rig.mesh, GAP_RESOLUTION))
    share = vertex_shares(rig.mesh)
    scores = []
    for done, (name, method) in enumerate(methods.items()):
        progress(rig.name, (done + 1) / (len(methods) + 1))
        try:
            found = method(rig)
        except ParameterError:
            raise  # the same for all rigs: whoever asked must know
        except CutcellError as error:
            found = BaselineBinding(None, failed=str(error))
        scores.append(_score(name, rig, found, share, gaps))
    progress(rig.name, 1.0)
    joints = int(rig.skeleton.deform.sum())
    counts = (len(rig.mesh.vertices), joints, len(rig.clips), len(gaps))
    return RigScore(rig.name, *counts, tuple(scores))


def _score(
    name: str,
    rig: Rig,
    found: BaselineBinding,
    share: NDArray[np.float64],
    gaps: NDArray[np.int32],
) -> MethodScore:
    seconds = float(sum(found.seconds.values()))
    if found.weights is None or rig.weights is None:
        return MethodScore(name, found.failed, seconds=seconds, warnings=found.warnings)
    precision, recall = precision_recall(found.weights, rig.weights, shares=share)
    error = deformation_error(rig, found.weights, rig.weights)
    clips = [clip.largest for clip in clip_error(rig, found.weights, rig.weights)]
    return MethodScore(
        name,
        l1=weight_l1(found.weights, rig.weights, share),
        precision=_number(precision),
        recall=_number(recall),
        deformation=error.mean,
        clips=float(np.mean(clips)) if clips else None,
        unweighted=unweighted(found.weights, share),
        crosstalk=_number(crosstalk(found.weights, gaps).mean),
        seconds=seconds,
        warnings=found.warnings,
        worst=tuple(error.worst(3)),
    )


def _number(value: float) -> float | None:
    return None if np.isnan(value) else float(value)


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
    shown = ("l1", "precision", "recall", "deformation", "clips", "crosstalk", "seconds")
    lines = ["## All rigs: median, mean (rigs)", ""]
    lines += _table(
        ["method", *(MEASURES[name] for name in shown), "no weight", "worst deformation"],
        [_summary_row(comparison, method, shown) for method in comparison.methods],
    )
    for name in ("l1", "deformation", "clips", "crosstalk", "seconds"):
        rows = [
            [rig.name, *(_text(getattr(score, name), name) for score in rig.scores)]
            for rig in comparison.rigs
        ]
        lines += ["", f"## {MEASURES[name]}", ""]
        lines += _table(["rig", *comparison.methods], rows)
    failures = [
        f"- {score.method} on {rig.name}: {score.failed}"
        for rig in comparison.rigs
        for score in rig.scores
        if score.failed
    ]
    if failures:
        lines += ["", "## Failed", "", *failures]
    return "\n".join(lines) + "\n"


def _summary_row(comparison: Comparison, method: str, shown: Sequence[str]) -> list[str]:
    cells = []
    for name in shown:
        found = comparison.statistic(method, name)
        cells.append(f"{_text(found.median, name)}, {_text(found.mean, name)} ({found.count})")
    none = comparison.statistic(method, "unweighted").mean
    worst = comparison.statistic(method, "deformation")
    cells.append("–" if none is None else f"{none:.1%}")
    cells.append(f"{_text(worst.worst, 'deformation')} {worst.worst_rig}".strip())
    return [method, *cells]


def _text(value: float | None, measure: str) -> str:
    if value is None:
        return "–"
    digits = {"deformation": 1, "clips": 1, "seconds": 2}.get(measure, 3)
    return f"{value:.{digits}f}"


def _table(head: Sequence[str], rows: Iterable[Sequence[str]]) -> list[str]:
    align = ["---", *["---:"] * (len(head) - 1)]
    return ["| " + " | ".join(row) + " |" for row in (head, align, *rows)]
