"""Scores of methods on rigs, and their statistics over all rigs."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import asdict, dataclass, replace
from typing import Any

import numpy as np

from ...metrics import Turn


@dataclass(frozen=True)
class MethodScore:
    """Scores of one method on one rig. None: it failed, or there is nothing to measure.

    Parameters
    ----------
    method : str
    failed : str
        Why there are no weights; empty where there are.
    l1, precision, recall
        Of the weights; see `cutcell_lab.metrics`.
    deformation : float
        cm², joints turned by 30°.
    clips : float
        The same over the file's own clips, their mean.
    unweighted : float
        Share of the welded vertices without weight.
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
    """Scores of all methods on one rig.

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
    """Scores of all methods on all rigs.

    Parameters
    ----------
    rigs : tuple of RigScore
    methods : tuple of str
    """

    rigs: tuple[RigScore, ...]
    methods: tuple[str, ...]

    def statistic(self, method: str, measure: str) -> Statistic:
        """Summarise a measure, a field of `MethodScore`, over the rigs where a method has it.

        The worst is the lowest precision and recall, and the highest of all else.
        """
        index = self.methods.index(method)
        pairs = [(getattr(rig.scores[index], measure), rig.name) for rig in self.rigs]
        values = [(value, name) for value, name in pairs if value is not None]
        if not values:
            return Statistic(0, None, None, None, "")
        pick = min if measure in ("precision", "recall") else max
        worst, name = pick(values, key=lambda pair: pair[0])
        numbers = [value for value, _ in values]
        return Statistic(
            len(values), float(np.median(numbers)), float(np.mean(numbers)), worst, name
        )

    def failures(self) -> dict[tuple[str, str], list[str]]:
        """Group what failed: the names of the rigs by method and reason."""
        failures: dict[tuple[str, str], list[str]] = {}
        for rig in self.rigs:
            for score in rig.scores:
                if score.failed:
                    failures.setdefault((score.method, score.failed), []).append(rig.name)
        return failures

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

    @classmethod
    def from_dict(cls, document: Mapping[str, Any]) -> Comparison:
        """Return what `to_dict` was made from."""
        return cls(tuple(_rig_score(rig) for rig in document["rigs"]), tuple(document["methods"]))

    def merged(self, other: Comparison) -> Comparison:
        """Add another comparison: its methods to these rigs, its rigs to these.

        Where both have a method on a rig, the other one's score is taken. Rigs that lack a
        method of the result get a failed score.
        """
        methods = tuple(dict.fromkeys((*self.methods, *other.methods)))
        rigs = {rig.name: rig for rig in self.rigs}
        for rig in other.rigs:
            earlier = rigs.get(rig.name, rig)
            by_method = {score.method: score for score in (*earlier.scores, *rig.scores)}
            rigs[rig.name] = replace(rig, scores=tuple(by_method.values()))
        return Comparison(tuple(_complete(rig, methods) for rig in rigs.values()), methods)


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


def _complete(rig: RigScore, methods: Iterable[str]) -> RigScore:
    by_method = {score.method: score for score in rig.scores}
    missing = "not measured"
    return replace(
        rig,
        scores=tuple(by_method.get(name) or MethodScore(name, failed=missing) for name in methods),
    )


def _rig_score(document: Mapping[str, Any]) -> RigScore:
    scores = [
        MethodScore(
            **{
                **score,
                "warnings": tuple(score["warnings"]),
                "worst": tuple(Turn(**turn) for turn in score["worst"]),
            }
        )
        for score in document["scores"]
    ]
    return RigScore(**{**document, "scores": tuple(scores)})
