"""How good the weights of a network are at the points of a character that it sees."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

import numpy as np
from numpy.typing import NDArray

from cutcell.rig import Skeleton, TriangleMesh
from cutcell_lab.networks import Sample

from ..metrics import deformation_error, precision_recall, weight_l1
from ..metrics.deformation import longest_side

SAME_MAKER = ("quaternius_", "quat_", "deok_dino_quant", "packt_woman", "m2m_eagle")
"""Characters of rigs and wild by the maker of train, surely or probably (SOURCES.md)."""
PART, LOST = 0.15, 0.01
"""The published evaluation drops weights below this part of a point's largest, but for points that
lose less than this."""

Scores = dict[str, list[float]]
"""By character: L1, precision, recall, cm², and the same after dropping."""


def scores(sample: Sample, weights: NDArray) -> list[float]:
    """Measure weights at the points of a character, as they are and after dropping."""
    return [*_measured(sample, weights), *_measured(sample, dropped(weights))]


def dropped(weights: NDArray) -> NDArray[np.float64]:
    """Return weights without those that the published evaluation drops."""
    remaining = np.where(weights >= PART * weights.max(axis=1, keepdims=True), weights, 0)
    total = remaining.sum(axis=1, keepdims=True)
    return np.where(weights.sum(axis=1, keepdims=True) - total < LOST, weights, remaining / total)


def _measured(sample: Sample, weights: NDArray) -> list[float]:
    has_target = sample.target.any(axis=1)  # type: ignore[union-attr]
    points, target = sample.points[has_target], sample.target[has_target]  # type: ignore[index]
    weights = weights[has_target]
    corners = np.arange(len(points) - 2)[:, None] + np.arange(3)
    mesh = TriangleMesh(points, corners)
    skeleton = Skeleton(sample.joints, sample.parents)
    error = deformation_error((mesh, skeleton), weights, target, count="vertices")
    # The longest side of the character is 1, that of the points that were drawn a little less.
    centimetres = error.mean * longest_side(mesh) ** 2
    return [weight_l1(weights, target), *precision_recall(weights, target), centimetres]


def groups(names: Iterable[str]) -> dict[str, list[str]]:
    """Part characters by who made them."""
    parted: dict[str, list[str]] = {"other makers": [], "same maker": []}
    for name in names:
        parted["same maker" if name.startswith(SAME_MAKER) else "other makers"].append(name)
    return parted


def means(by_name: Scores, names: Sequence[str], at: slice = slice(0, 4)) -> NDArray:
    """Average each measure over characters; nan where a measure has no value is left out."""
    return np.nanmean([by_name[name][at] for name in names], axis=0)
