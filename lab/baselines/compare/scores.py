"""Scores of methods on rigs, and their statistics over all rigs."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import asdict, dataclass, field, replace
from typing import Any

import numpy as np

from ...metrics import METRICS, Turn


@dataclass(frozen=True)
class MethodScore:
    """Scores of one method on one rig. None: it failed, or there is nothing to measure.

    Parameters
    ----------
    method : str
    failed : str
        Why there are no weights; empty where there are.
    values : mapping of str to float or None
        By name of the metric, see `cutcell_lab.metrics.METRICS`. The one that failed has only its
        seconds.
    warnings : tuple of str
    worst : tuple of Turn
        The joints and axes with the greatest error.
    """

    method: str
    failed: str = ""
    values: Mapping[str, float | None] = field(default_factory=dict)
    warnings: tuple[str, ...] = ()
    worst: tuple[Turn, ...] = ()

    def to_dict(self) -> dict[str, Any]:
        """Return the score as plain lists, dicts and numbers, with a key for each metric."""
        document = asdict(self)
        return {**document, **document.pop("values")}

    @classmethod
    def from_dict(cls, document: Mapping[str, Any]) -> MethodScore:
        """Return what `to_dict` was made from."""
        values = {name: document[name] for name in METRICS if name in document}
        worst = tuple(Turn(**turn) for turn in document["worst"])
        warnings = tuple(document["warnings"])
        return cls(document["method"], document["failed"], values, warnings, worst)


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
    """One metric of one method over the rigs that have it.

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

    def statistic(self, method: str, metric: str) -> Statistic:
        """Summarise a metric over the rigs where a method has it."""
        index = self.methods.index(method)
        pairs = [(rig.scores[index].values.get(metric), rig.name) for rig in self.rigs]
        values = [(value, name) for value, name in pairs if value is not None]
        if not values:
            return Statistic(0, None, None, None, "")
        pick = max if METRICS[metric].lower_is_better else min
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
                method: {name: asdict(self.statistic(method, name)) for name in METRICS}
                for method in self.methods
            },
            "rigs": [
                {**vars(rig), "scores": [score.to_dict() for score in rig.scores]}
                for rig in self.rigs
            ],
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


def _complete(rig: RigScore, methods: Iterable[str]) -> RigScore:
    by_method = {score.method: score for score in rig.scores}
    missing = "not measured"
    return replace(
        rig,
        scores=tuple(by_method.get(name) or MethodScore(name, failed=missing) for name in methods),
    )


def _rig_score(document: Mapping[str, Any]) -> RigScore:
    scores = tuple(MethodScore.from_dict(score) for score in document["scores"])
    return RigScore(**{**document, "scores": scores})
