"""Application of layers to weights: pure functions on arrays."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array

from ...weights.prune import prune
from .layer import Layer, Mode
from .painted import Painted
from .sources import RigSources, Which, vertices_of

ROWS_TOGETHER = 1000
"""Rows that are changed at a time: some arrays of them fit a processor's cache."""


def apply_layers(
    weights: NDArray[np.float64],
    layers: Iterable[Layer],
    sources: RigSources,
    after: Callable[[Layer, NDArray[np.float64]], None] = lambda layer, weights: None,
) -> NDArray[np.float64]:
    """Return weights with layers over them, from bottom to top.

    Only rows that a layer has a strength above 0 for are changed: all others stay the same, bit
    for bit. Where a layer is opaque, the rows are those of its content, bit for bit. `after` is
    called with each layer that was applied, and the weights up to it.

    Shapes: weights (n, j), which stay as they are; returns (n, j).
    """
    return _applied(weights, False, layers, sources, None, after)


def apply_to_rows(
    weights: NDArray[np.float64],
    layers: Iterable[Layer],
    sources: RigSources,
    rows: NDArray[np.intp],
) -> None:
    """Apply layers to some rows (k,), ascending, of weights (n, j), in place.

    Other rows are not read, so that no content may follow from several rows.
    """
    _applied(weights, True, layers, sources, rows, lambda layer, weights: None)


def strength_of(
    layer: Layer, component: Callable[[], NDArray[np.integer]], count: int
) -> NDArray[np.float64]:
    """Return how strongly a layer acts at each of `count` vertices; 0 where it cannot."""
    strength = np.zeros(count)
    if layer.is_active:
        which, how = _masked(layer, component, count)
        vertices: Any = slice(None) if which is None else which
        strength[vertices] = how if how.ndim == 0 else how[vertices]
        if isinstance(layer.content, Painted):
            strength *= np.bincount(layer.content.vertices, minlength=count)
    return strength


def _applied(
    result: NDArray[np.float64],
    is_own: bool,
    layers: Iterable[Layer],
    sources: RigSources,
    within: Which,
    after: Callable[[Layer, NDArray[np.float64]], None],
) -> NDArray[np.float64]:
    for layer in layers:
        if not layer.is_active:
            continue
        which, strength = _masked(layer, sources.component, len(result))
        if within is not None:
            which = within if which is None else np.intersect1d(which, within, assume_unique=True)
        if layer.content.by_rows and not is_own:
            result, is_own = result.copy(), True
        for part in _blocks(which, result) if layer.content.by_rows else [which]:
            some, rows = sources.rows(layer, result, part)
            is_whole = some is None and np.all(strength == 1) and layer.mode == "replace"
            if is_whole and not isinstance(rows, csr_array):
                result, is_own = rows, False
            elif some is None or len(some):
                if not is_own:
                    result, is_own = result.copy(), True
                some = np.arange(len(result)) if some is None else some
                _put(result, some, rows, strength, sources, layer.mode)
        after(layer, result)
    return result


def _masked(
    layer: Layer, component: Callable[[], NDArray[np.integer]], count: int
) -> tuple[Which, NDArray[np.float64]]:
    """Return the vertices of a layer's mask, and the layer's strength there.

    Returns shapes (k,), or None for all vertices; strength () or (n,), the same everywhere or at
    each vertex.
    """
    mask, opacity = layer.mask, np.float64(layer.opacity)
    which = vertices_of(mask, component)
    if mask.strengths is None:
        return which, np.asarray(opacity)
    strength = np.zeros(count)
    strength[which] = opacity * mask.strengths
    return which, strength


def blended(
    below: NDArray[np.float64],
    content: NDArray[np.float64],
    strength: NDArray[np.float64],
    max_influences: int | None,
    priority: NDArray[np.intp],
    mode: Mode = "replace",
) -> NDArray[np.float64]:
    """Return rows between those below and those that a content makes of them by its mode.

    Shapes: below, content (k, j), strength (k,), 0 to 1; priority (j,), the order of joints with
    the same weight. Rows with strength 0, and in mode "replace" with 1, are those of one side, bit
    for bit; others have at most `max_influences` weights and sum to one. Rows that would be left
    empty stay as they are below.
    """
    share = strength[:, None]
    rows = {
        "replace": lambda: (1 - share) * below + share * content,
        "add": lambda: below + share * content,
        "scale": lambda: below * (1 - share + share * content),
    }[mode]()
    is_whole = (strength == 1) & (mode == "replace")
    between = (strength > 0) & ~is_whole & rows.any(axis=1)
    rows[between] = prune(csr_array(rows[between]), max_influences, 0.0, priority).toarray()
    stays = (strength == 0) | ~(between | is_whole)
    rows[stays] = below[stays]
    rows[is_whole] = content[is_whole]
    return rows


def _put(
    weights: NDArray[np.float64],
    which: NDArray[np.intp],
    rows: Any,
    strength: NDArray[np.float64],
    sources: RigSources,
    mode: Mode,
) -> None:
    """Blend rows, shape (k, j), into weights in place."""
    if np.all(strength == 1) and mode == "replace":
        if isinstance(rows, csr_array):
            weights[which] = 0
            weights[np.repeat(which, np.diff(rows.indptr)), rows.indices] = rows.data
        else:
            weights[which] = rows
        return
    done = 0
    for part in _blocks(which, weights):
        some = rows[done : done + len(part)]
        done += len(part)
        some = some.toarray() if isinstance(some, csr_array) else some
        how, most = np.broadcast_to(strength, len(weights))[part], sources.method.max_influences
        weights[part] = blended(weights[part], some, how, most, sources.priority, mode)


def _blocks(which: Which, weights: NDArray[np.float64]) -> Iterator[NDArray[np.intp]]:
    """Yield some vertices at a time, of all for None."""
    for start in range(0, len(weights) if which is None else len(which), ROWS_TOGETHER):
        end = min(start + ROWS_TOGETHER, len(weights))
        yield np.arange(start, end) if which is None else which[start : start + ROWS_TOGETHER]
