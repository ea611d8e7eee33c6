"""Gradient-boosted trees as arrays, evaluated without the library that trained them."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.special import expit

from ...runtime.compiled import compiled
from ...runtime.threads import in_threads, parts

STORED = Path(__file__).with_name("forest.npz")


@dataclass(frozen=True, eq=False)
class Forest:
    """Binary trees whose leaves add up to the logit of a probability.

    Parameters
    ----------
    root : array, shape (t,), int32
        The first node of each tree.
    feature : array, shape (n,), int16
        That a node divides by; -1 for a leaf.
    value : array, shape (n,), float64
        The largest value of the feature on the left; the summand of a leaf.
    right : array, shape (n,), int32
        The node on the right; on the left is the next one.
    baseline : float
        The first summand.
    """

    root: NDArray[np.int32]
    feature: NDArray[np.int16]
    value: NDArray[np.float64]
    right: NDArray[np.int32]
    baseline: float

    def probability(self, features: NDArray[np.float32]) -> NDArray[np.float64]:
        """Predict the probability for each row of features (p, f)."""
        logit = np.empty(len(features))

        def evaluate(part: slice) -> None:
            tree = self.root, self.feature, self.value, self.right
            _evaluate(*tree, self.baseline, features[part], logit[part])

        in_threads(evaluate, parts(len(features)))
        return np.asarray(expit(logit))

    def save(self, path: Path) -> None:
        """Write the arrays, compressed."""
        arrays: dict[str, Any] = vars(self)
        np.savez_compressed(path, **arrays)

    @classmethod
    def load(cls, path: Path) -> Forest:
        """Read the arrays."""
        with np.load(path) as arrays:
            return cls(**{**arrays, "baseline": float(arrays["baseline"])})


@cache
def stored_forest() -> Forest:
    """Return the model that is part of the package."""
    return Forest.load(STORED)


@compiled
def _evaluate(root, feature, value, right, baseline, features, logit):
    for p in range(len(features)):
        total = baseline
        for tree in range(len(root)):
            node = root[tree]
            while feature[node] >= 0:
                node = node + 1 if features[p, feature[node]] <= value[node] else right[node]
            total += value[node]
        logit[p] = total
