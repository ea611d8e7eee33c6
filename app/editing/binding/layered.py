"""Weights of layers that are computed otherwise than the base, and layers over the base."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any
from weakref import WeakKeyDictionary

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array

import cutcell
from cutcell.binding import Binding
from cutcell.binding.stages import bind_layer
from cutcell.editing import Computed, Edits, Layer
from cutcell.editing.layers import RigSources, StackedRows
from cutcell.geodesics import BoneDistances
from cutcell.rig import Rig
from cutcell.runtime.progress import Progress
from cutcell.runtime.threads import cancellable
from cutcell.weights import keep_strongest

from ...derive.memo import Memo

CACHED = 4
"""Number of contents whose weights are remembered."""


@dataclass(frozen=True, eq=False)
class Recomputed:
    """Weights (n, j) of many influences for a layer that is computed otherwise than the base."""

    distances: BoneDistances
    weights: csr_array


_before: WeakKeyDictionary[Any, dict[Any, Recomputed]] = WeakKeyDictionary()


def recomputed_layers(edits: Edits) -> dict[str, Layer]:
    """Return the layers that are computed otherwise than the base, by keys of what they hold."""
    return {
        _key(layer): layer
        for layer in edits.stack()
        if layer.is_active and isinstance(layer.content, Computed) and layer.content != edits.reach
    }


def _key(layer: Layer) -> str:
    content = layer.content
    mask = layer.mask.to_data() if isinstance(content, Computed) and content.as_skin else {}
    return json.dumps([content.to_data(), mask], sort_keys=True)


def recomputed(
    bound: Any,
    reach: Computed,
    options: dict[str, Any],
    key: str,
    rig: Rig,
    layer: Layer,
    progress: Progress,
) -> Recomputed:
    """Compute the weights of a layer, unless that was done with the same distances."""
    cache = _before.setdefault(bound, {})
    about = key, repr(sorted(options.items()))
    if about not in cache:
        cache[about] = recompute(bound, reach, options, rig, layer, progress)
        for old in list(cache)[:-CACHED]:
            del cache[old]
    return cache[about]


def recompute(
    bound: Any, reach: Computed, options: dict[str, Any], rig: Rig, layer: Layer, progress: Progress
) -> Recomputed:
    """Compute the weights of a layer by options of a method, with a `Bound` for the base."""
    base = replace(bound.binding, method=cutcell.ANIMATION.with_options(**options))

    def work(report: Progress) -> Binding:
        return bind_layer(rig, base, reach, layer, report, scaled=False)

    binding = cancellable(work, progress, "weights")
    return Recomputed(binding.distances, binding.rows)


def layered(
    rig: Rig,
    binding: Binding,
    edits: Edits,
    recomputed: Mapping[str, Recomputed | None],
    memo: Memo | None = None,
) -> Binding:
    """Return a binding with layers over its weights.

    Weights of layers that are not given are those of the base. The memo keeps what strokes of a
    brush leave as it is.
    """
    few = binding.method

    def computed(layer: Layer) -> NDArray[np.float64]:
        result = recomputed.get(_key(layer))
        if result is None:
            return binding.rows.toarray()
        assert isinstance(layer.content, Computed)
        method = layer.content.method(few)
        options = method.max_influences, method.threshold
        return keep_strongest(result.distances, result.weights, *options).toarray()

    sources = RigSources(rig, few, binding.graph, computed)
    inputs = rig, binding, *(one for pair in sorted(recomputed.items()) for one in pair)
    stacked = (memo or Memo())("stacked", inputs, lambda: StackedRows(binding.rows, sources))
    return replace(binding, rows=stacked.rows(edits.stack()))
