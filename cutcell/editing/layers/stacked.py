"""Weights of stacks that differ little from each other, of which only changed rows are computed."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array, vstack

from .apply import apply_layers, apply_to_rows, strength_of
from .layer import Layer
from .painted import Painted
from .sources import RigSources

Stack = tuple[Layer, ...]
CACHED = 4
"""Stacks whose weights are remembered: the newest, what lies below the layer that is changed, and
those that undo returns to."""
LARGEST_SHARE = 0.25
"""Share of rows above which all are computed at once."""


class StackedRows:
    """Weights of stacks of layers over the same base.

    They are the same, bit for bit, as those of `apply_layers`. Of a stack that differs from the
    last one, only the rows that can differ are computed: a stroke changes few of them.

    Parameters
    ----------
    base : csr_array, shape (n, j)
        Weights below all layers.
    sources : RigSources
    """

    def __init__(self, base: csr_array, sources: RigSources) -> None:
        self._sources = sources
        self._base: tuple[Stack, csr_array] = ((), base)
        self._results: list[tuple[Stack, csr_array]] = []

    def rows(self, layers: Iterable[Layer]) -> csr_array:
        """Return the weights (n, j) with layers over the base, from bottom to top."""
        stack = tuple(layer for layer in layers if layer.is_active)
        result = self._remembered(stack)
        if result is None:
            rows = self._changed(stack)
            result = self._remembered(stack) or (stack, rows)  # of another thread, meanwhile
        if stack:
            rest = [one for one in self._results if one is not result]
            self._results = [result, *rest][:CACHED]
        return result[1]

    def _remembered(self, stack: Stack) -> tuple[Stack, csr_array] | None:
        return next((one for one in [*self._results, self._base] if one[0] == stack), None)

    def _changed(self, stack: Stack) -> csr_array:
        """Return the rows of another stack than the remembered ones."""
        old, rows = [*self._results, self._base][0]
        start = _same(old, stack[:-1])
        end = _same(old[start:][::-1], stack[start:][::-1])
        changed = self._differing(old[start : len(old) - end], stack[start : len(stack) - end])
        if not len(changed):
            return rows
        is_much = len(changed) > LARGEST_SHARE * rows.shape[0]
        if is_much or any(layer.content.reads_others for layer in stack[start:]):
            base = self._base[1].toarray()
            return csr_array(apply_layers(base, stack, self._sources))
        weights = np.zeros(rows.shape)  # only the pages of rows that are written take memory
        weights[changed] = self.rows(stack[:start])[changed].toarray()
        apply_to_rows(weights, stack[start:], self._sources, changed)
        return _replaced(rows, changed, csr_array(weights[changed]))

    def _differing(self, old: Stack, new: Stack) -> NDArray[np.intp]:
        """Return the vertices, ascending, at which other layers in one place make a difference."""
        count = self._base[1].shape[0]
        before, after = (
            [strength_of(layer, self._sources.component, count) for layer in layers]
            for layers in (old, new)
        )
        differs = np.any([*before, *after], axis=0) if before or after else np.zeros(count, bool)
        if len(old) == len(new) == 1 and old[0].mode == new[0].mode:
            one, other = old[0].content, new[0].content
            is_alike = before[0] == after[0]
            if one == other:
                differs &= ~is_alike
            elif isinstance(one, Painted) and isinstance(other, Painted):
                is_alike[one.differing(other)] = False
                differs &= ~is_alike
        return np.flatnonzero(differs)


def _same(one: Stack, other: Stack) -> int:
    """Return how many layers two stacks begin with alike."""
    pairs = enumerate(zip(one, other, strict=False))
    return next((k for k, (a, b) in pairs if a != b), min(len(one), len(other)))


def _replaced(rows: csr_array, which: NDArray[np.intp], others: csr_array) -> csr_array:
    """Return a matrix with other rows, (k, j), at some places, (k,)."""
    order = np.arange(rows.shape[0])
    order[which] = rows.shape[0] + np.arange(len(which))
    return csr_array(vstack([rows, others], format="csr")[order])
