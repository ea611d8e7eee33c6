"""Result of an audit: pairs, clusters, assets to keep, and verdicts of a reviewer."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from itertools import chain
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cutcell.checks import check_choice

from ..read.sources import Source
from .likeness import TWIN, VARIANT, Similarity

EPSILON = 0.5
TIERS = (("twin", TWIN), ("variant", VARIANT))
DUPLICATE, DIFFERENT = "duplicate", "different"
"""Verdicts of a reviewer on a pair."""


@dataclass(frozen=True)
class Pair:
    """Two near-duplicates.

    Parameters
    ----------
    a, b : int
        Places in the lists of names.
    joints, surface : float
        Squared Chamfer distances, of the joints and of the surface.
    likeness : Similarity
        The second measure.
    """

    a: int
    b: int
    joints: float
    surface: float
    likeness: Similarity

    @property
    def tier(self) -> str:
        """How close: "twin" up to 5e-4, "variant" up to 2e-3, "near" up to the threshold."""
        return next((name for name, most in TIERS if self.surface <= most), "near")


@dataclass(frozen=True, eq=False)
class Audit:
    """Near-duplicates of a data set, or between two.

    Parameters
    ----------
    names, others : list of str
        Of the first set, and of the second; the same where one set was compared with itself.
    pairs : list of Pair
        Near-duplicates, nearest first.
    posed : list of Pair
        Characters of one skeleton whose surfaces differ more; `joints` and `surface` are
        infinite.
    candidates : int
        Number of pairs that passed stage 1.
    failed : dict of str to str
        Reasons why assets were left out, by name.
    sources, other_sources : list of Source
        Of the names.
    seconds : dict of str to float
        "reading", "pairs".
    threshold : float
        T_V.
    least : int
        DBSCAN's MinPts.
    verdicts : mapping of (str, str) to str
        Verdicts on pairs, by their names: `DUPLICATE` or `DIFFERENT`.
    """

    names: list[str]
    others: list[str]
    pairs: list[Pair]
    posed: list[Pair]
    candidates: int
    failed: dict[str, str]
    sources: list[Source]
    other_sources: list[Source]
    seconds: dict[str, float]
    threshold: float
    least: int
    verdicts: Mapping[tuple[str, str], str] = field(default_factory=dict)

    @property
    def crossed(self) -> bool:
        """Whether two sets were compared, rather than one with itself."""
        return self.sources is not self.other_sources

    def verdict(self, pair: Pair) -> str:
        """Return the verdict on a pair; empty without one."""
        return self.verdicts.get((self.names[pair.a], self.others[pair.b]), "")

    def overrule(self, pair: Pair, verdict: str) -> Audit:
        """Return the audit with a verdict on a pair; an empty one removes the verdict.

        Raises
        ------
        ParameterError
            There is no such verdict.
        """
        check_choice("verdict", verdict, (DUPLICATE, DIFFERENT, ""))
        names = self.names[pair.a], self.others[pair.b]
        verdicts = {**self.verdicts, names: verdict}
        return replace(
            self, verdicts={names: answer for names, answer in verdicts.items() if answer}
        )

    @property
    def duplicates(self) -> list[Pair]:
        """Pairs that are near enough and not rejected, and pairs that the reviewer added.

        A pair with the verdict `DUPLICATE` has distance 0, so that it is always in one cluster.
        """
        if not self.verdicts:
            return self.pairs
        verdicts = [(pair, self.verdict(pair)) for pair in chain(self.pairs, self.posed)]
        return [
            replace(pair, surface=0.0) if answer else pair
            for pair, answer in verdicts
            if answer == DUPLICATE or (not answer and pair.surface < np.inf)
        ]

    @cached_property
    def labels(self) -> NDArray[np.int64] | None:
        """The cluster of each of the first set, -1 for none; None where two were compared."""
        if self.crossed:
            return None
        return clusters(len(self.names), self.duplicates, self.threshold, self.least)

    @cached_property
    def keep(self) -> list[str]:
        """The first set without duplicates: its unclustered assets, and one of each cluster.

        Where two sets were compared, those of the first without a match in the second.
        """
        if self.labels is None:
            matched = {pair.a for pair in self.duplicates}
            return [name for k, name in enumerate(self.names) if k not in matched]
        first = {label: k for k, label in reversed(list(enumerate(self.labels.tolist())))}
        return [
            name
            for k, (name, label) in enumerate(zip(self.names, self.labels.tolist(), strict=True))
            if label < 0 or first[label] == k
        ]

    def rows(self) -> list[dict[str, Any]]:
        """Return all pairs as rows of a table; posed ones have the tier "posed"."""
        return [
            {
                "a": self.names[pair.a],
                "b": self.others[pair.b],
                "tier": tier or pair.tier,
                "joints": pair.joints,
                "surface": pair.surface,
                "verdict": self.verdict(pair),
                **vars(pair.likeness),
            }
            for tier, pairs in (("", self.pairs), ("posed", self.posed))
            for pair in pairs
        ]

    def to_dict(self) -> dict[str, Any]:
        """Return the whole as plain data."""
        tiers = [*(pair.tier for pair in self.pairs), *("posed" for _ in self.posed)]
        kinds = [pair.likeness.kind for pair in chain(self.pairs, self.posed)]
        labels = [] if self.labels is None else self.labels.tolist()
        clusters = [
            [self.names[k] for k in np.flatnonzero(np.array(labels) == label)]
            for label in sorted(set(labels) - {-1})
        ]
        return {
            "assets": len(self.names),
            "others": len(self.others) if self.crossed else None,
            "candidates": self.candidates,
            "pairs": len(self.pairs),
            "tiers": {tier: tiers.count(tier) for tier in ("twin", "variant", "near", "posed")},
            "kinds": {kind: kinds.count(kind) for kind in sorted(set(kinds))},
            "overruled": len(self.verdicts),
            "clusters": clusters,
            "keep": self.keep,
            "failed": self.failed,
            "seconds": {name: round(value, 3) for name, value in self.seconds.items()},
        }


def clusters(count: int, pairs: Sequence[Pair], threshold: float, least: int) -> NDArray[np.int64]:
    """Cluster characters by DBSCAN on 1 - exp(-D / T_V), eps 0.5; -1 for those in no cluster."""
    try:
        from sklearn.cluster import DBSCAN
    except ImportError:
        from cutcell.errors import MissingLibraryError

        raise MissingLibraryError(
            "clusters are found by scikit-learn, which is not installed; try: pip install "
            "'cutcell[dataset]'"
        ) from None
    from scipy.sparse import csr_matrix

    if not count or not pairs:
        return np.full(count, -1, np.int64)
    ends = np.array([(pair.a, pair.b) for pair in pairs])
    distances = -np.expm1(-np.array([pair.surface for pair in pairs]) / threshold)
    # A stored zero might be treated as a missing pair: duplicates must not vanish.
    distances = np.maximum(distances, np.finfo(float).tiny)
    rows, columns = np.concatenate([ends, ends[:, ::-1]]).T
    matrix = csr_matrix((np.tile(distances, 2), (rows, columns)), shape=(count, count))
    result = DBSCAN(eps=EPSILON, min_samples=least, metric="precomputed").fit(matrix)
    return result.labels_.astype(np.int64)
