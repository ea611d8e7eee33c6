"""Normalisation of the weights that a file contains."""

from __future__ import annotations

from collections.abc import Iterable
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..rig import Part
from ..runtime.display import listed
from ..runtime.memory import check_matrix

LARGE = 1e300
"""Weights above it are scaled down before they are added: a sum must not overflow."""
ROUNDING = 0.01
"""Sums of weights that are stored in 8 bits differ from one by up to this."""
COPIES = 2
"""Of the matrix at a time, before and after its rows are scaled."""


class ReadWeights(NamedTuple):
    """Weights as they were read."""

    weights: NDArray[np.float64] | None
    """(n, j): rows sum to one or to zero. None if there are no weights."""
    warnings: tuple[str, ...]  # A sentence if some were left out
    sums: NDArray[np.float64] | None
    """(n,): what each row summed to in the file; NaN where a weight was left out."""


NO_WEIGHTS = ReadWeights(None, (), None)


def summed(
    rows: NDArray, columns: NDArray, values: NDArray, shape: tuple[int, int], owner: str
) -> ReadWeights:
    """Return the weight matrix of a list of influences, with rows that sum to one or to zero.

    A weight that is negative or not a finite number counts as none.

    Shapes: rows, columns, values (k,).
    """
    with np.errstate(invalid="ignore"):  # a signalling NaN becomes a quiet one
        values = values.astype(np.float64)
    good = np.isfinite(values) & (values >= 0)
    warnings: tuple[str, ...] = ()
    sums = np.zeros(shape[0])
    if not good.all():
        sums[rows[~good]] = np.nan
        bad = len(np.unique(rows[~good]))
        warnings = (
            f"{owner}: {bad:,} of {shape[0]:,} vertices {'has' if bad == 1 else 'have'} weights "
            "that are negative or not a number; these weights count as none",
        )
        rows, columns, values = rows[good], columns[good], values[good]
    if values.max(initial=0) > LARGE:
        top = np.zeros(shape[0])
        np.maximum.at(top, rows, values)
        values = values / np.where(top > 0, top, 1)[rows]
    check_matrix(*shape, copies=COPIES)
    weights = np.zeros(shape)
    np.add.at(weights, (rows, columns), values)
    return ReadWeights(normalised(weights), warnings, sums + weights.sum(axis=1))


def sum_warnings(
    sums: NDArray[np.float64] | None, faces: NDArray[np.integer], parts: Iterable[Part]
) -> list[str]:
    """Count the vertices whose weights sum to zero, or not to one, with the names of their meshes.

    Vertices without a face are not counted, nor those with a weight that counts as none.

    Shapes: sums (n,), faces (m, 3).
    """
    if sums is None:
        return []
    is_used = np.zeros(len(sums), bool)
    is_used[faces] = True
    empty = is_used & (sums == 0)
    off = is_used & (sums > 0) & (np.abs(sums - 1) > ROUNDING)
    warnings = []
    for rows, what in (
        (empty, "no weight, so that no joint moves them. `cutcell bind` gives them some"),
        (off, "weights that do not sum to one. They are scaled so that they do"),
    ):
        counts = {part.name: int(rows[part.vertices].sum()) for part in parts}
        names = listed([f"{name}: {count:,}" for name, count in counts.items() if count])
        if rows.any():
            verb = "has" if rows.sum() == 1 else "have"
            warnings.append(f"{rows.sum():,} of {is_used.sum():,} vertices ({names}) {verb} {what}")
    return warnings


def normalised(weights: NDArray) -> NDArray[np.float64]:
    """Scale each row to sum to one; rows of zero stay zero."""
    if weights.max(initial=0) > LARGE:
        top = weights.max(axis=1, keepdims=True)
        weights = weights / np.where(top > 0, top, 1)
    sums = weights.sum(axis=1, keepdims=True)
    return np.divide(weights, sums, out=np.zeros(weights.shape), where=sums > 0)
