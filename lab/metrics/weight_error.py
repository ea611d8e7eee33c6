"""Errors of weights (paper section 4.3)."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from cutcell.checks import check_number
from cutcell.errors import ParameterError, WeightsError

THRESHOLD = 0.001
"""A joint moves a vertex if its weight is greater."""
SUM_TOLERANCE = 1e-3
"""Weights stored in 8 bits sum to one within this."""


def weight_l1(predicted: ArrayLike, reference: ArrayLike, shares: ArrayLike | None = None) -> float:
    """Compute the mean L1 distance: over the joints summed, over the vertices averaged.

    Parameters
    ----------
    predicted, reference : array_like, shape (n, j)
        Weights; rows sum to one, or to zero where a vertex has none.
    shares : array_like, shape (n,), optional
        How much each vertex counts, such as `vertex_shares(mesh)`; evenly when left out.

    Returns
    -------
    float
        0 for equal weights, 2 where no vertex shares a joint with its reference.

    Raises
    ------
    WeightsError
        The two do not fit each other, or contain numbers that are no weights.
    ParameterError
        Shares that do not fit.

    References
    ----------
    Paper section 4.3; Xu et al. 2020 (RigNet).
    """
    weights, targets = checked_pair(predicted, reference)
    share = checked_shares(shares, len(weights))
    return float(share @ np.abs(weights - targets).sum(axis=1))


def precision_recall(
    predicted: ArrayLike,
    reference: ArrayLike,
    shares: ArrayLike | None = None,
    *,
    threshold: float = THRESHOLD,
) -> tuple[float, float]:
    """Compare which joints move which vertices, whatever the amounts.

    Parameters
    ----------
    predicted, reference : array_like, shape (n, j)
    shares : array_like, shape (n,), optional
        How much each vertex counts; evenly when left out.
    threshold : float
        A joint moves a vertex if its weight is greater, 0 to 1; 0.001 as in the paper.

    Returns
    -------
    precision : float
        The part of all predicted pairs (vertex, joint) that the reference has too.
    recall : float
        The part of the reference's pairs that were predicted. Either is nan where there is
        no pair to take the part of.

    Raises
    ------
    WeightsError, ParameterError
        See `weight_l1`.

    References
    ----------
    Paper section 4.3; Xu et al. 2020 (RigNet), with a threshold of 0.0001.
    """
    weights, targets = checked_pair(predicted, reference)
    share = checked_shares(shares, len(weights))
    threshold = check_number("threshold", threshold, 0, 1)
    influences, expected = weights > threshold, targets > threshold
    both = share @ (influences & expected).sum(axis=1)
    of_predicted, of_reference = share @ influences.sum(axis=1), share @ expected.sum(axis=1)
    nan = float("nan")
    return (
        float(both / of_predicted) if of_predicted > 0 else nan,
        float(both / of_reference) if of_reference > 0 else nan,
    )


def unweighted(weights: ArrayLike, shares: ArrayLike | None = None) -> float:
    """Return the share of vertices that have no weight at all, and so stay behind.

    Parameters
    ----------
    weights : array_like, shape (n, j)
    shares : array_like, shape (n,), optional
        How much each vertex counts; evenly when left out.

    Returns
    -------
    float
        0 to 1.
    """
    array = checked_weights(weights, "weights")
    return float(checked_shares(shares, len(array)) @ (array.sum(axis=1) == 0))


def checked_pair(
    predicted: ArrayLike, reference: ArrayLike
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return both as arrays (n, j) of weights that can be compared."""
    weights = checked_weights(predicted, "predicted")
    targets = checked_weights(reference, "reference")
    if weights.shape != targets.shape:
        raise WeightsError(
            f"the predicted weights have the shape {weights.shape}, the reference {targets.shape}; "
            "both must be for the same vertices and joints"
        )
    return weights, targets


def checked_weights(weights: ArrayLike, name: str) -> NDArray[np.float64]:
    """Return weights as an array (n, j) whose rows sum to one or are zero."""
    try:
        array = np.asarray(weights, np.float64)
    except (TypeError, ValueError):
        raise WeightsError(f"{name} must be an array of numbers (n, j)") from None
    if array.ndim != 2 or array.size == 0:
        raise WeightsError(f"{name} have the shape {array.shape}, expected (n, j)")
    total = array.sum(axis=1)
    fits = (np.abs(total - 1) <= SUM_TOLERANCE) | (array == 0).all(axis=1)
    bad = np.flatnonzero(~(fits & (array >= 0).all(axis=1)))
    if len(bad):
        raise WeightsError(
            f"{name} weights of vertex {bad[0]} are negative, not finite or sum to "
            f"{total[bad[0]]:.6g} instead of 1; {len(bad)} of {len(array)} vertices are so"
        )
    return array


def checked_shares(shares: ArrayLike | None, count: int) -> NDArray[np.float64]:
    """Return shares of `count` vertices that sum to one; even ones for None."""
    if shares is None:
        return np.full(count, 1.0 / count)
    array = np.asarray(shares, np.float64)
    if array.shape != (count,):
        raise ParameterError(f"shares have the shape {array.shape}, expected ({count},)")
    if not (np.isfinite(array) & (array >= 0)).all() or array.sum() == 0:
        raise ParameterError("shares must be finite, not negative, and not all zero")
    return array / array.sum()
