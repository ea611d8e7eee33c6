"""The step that lets the learned model correct the shares of joints."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ..context import Context, Step
from .features import Pairs, pair_features
from .forest import Forest, stored_forest

SHARPNESS = 1.75
"""Shares are the probabilities to this power."""
TRUST = 0.5
"""Part of the shares that the model decides; the rest the rules do."""
UNSURE = 0.5
"""Where the probabilities of a vertex's joints sum to less than this, the rules stand."""


def learned_shares(
    weights: NDArray[np.float64], pairs: Pairs, forest: Forest
) -> NDArray[np.float64]:
    """Return the shares of joints (k, j) that a model predicts, from the weights of the rules."""
    probability, count = forest.probability(pairs.features), len(weights)
    is_sure = np.bincount(pairs.vertex, probability, count) >= UNSURE
    shares = np.zeros(weights.shape)
    shares[pairs.vertex, pairs.joint] = probability**SHARPNESS
    shares /= np.maximum(shares.sum(axis=1, keepdims=True), 1e-300)
    return weights + TRUST * is_sure[:, None] * (shares - weights)


def correct_shares(context: Context, forest: Forest | None = None) -> NDArray[np.float64]:
    """Correct shares by a model, by default the stored one, if the skeleton is known."""
    weights, skeleton = context.weights, context.distances.skeleton
    if skeleton is None:
        return weights
    pairs = pair_features(context.division, context.diffusion.spread(weights), skeleton)
    return learned_shares(weights, pairs, forest or stored_forest())


LEARNED_STEP = Step("learned", correct_shares)
