"""Distances of a character, and weights of many influences that are computed with them."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import Any
from weakref import WeakKeyDictionary

from scipy.sparse import csr_array

import cutcell
from cutcell.binding import Binding
from cutcell.binding.stages import bind_base
from cutcell.editing import Computed
from cutcell.graph import CutCellGraph
from cutcell.rig import Rig
from cutcell.runtime.progress import Progress, silent
from cutcell.runtime.threads import cancellable

from ...derive.memo import Memo

graph_seconds: WeakKeyDictionary[CutCellGraph, float] = WeakKeyDictionary()
"""How long each graph took."""


@dataclass(frozen=True, eq=False)
class Influences:
    """Weights of many influences: sparse, as most of an (n, j) matrix is zero; and their options.

    `memo` has what was last made of them: most changes are of layers.
    """

    options: dict[str, Any]
    weights: csr_array
    memo: Memo = field(default_factory=Memo, repr=False)


@dataclass(frozen=True, eq=False)
class Bound:
    """Distances of the open character, and the weights that were computed with them.

    The weights are those of `influences`; the binding has none.
    """

    binding: Binding
    influences: Influences


def bind_wide(
    rig: Rig,
    graph: CutCellGraph,
    reach: Computed,
    options: dict[str, Any],
    falloff: dict[str, Any],
    progress: Progress,
) -> Bound:
    """Compute distances, and weights of many influences."""
    method = cutcell.ANIMATION.with_options(**options)

    def work(report: Progress) -> Binding:
        return bind_base(rig, method, reach, graph, progress=report, scaled=False)

    wide = cancellable(work, progress, "distances")
    seconds = {**wide.seconds, "graph": graph_seconds.get(graph, 0.0)}
    binding = replace(wide, rows=csr_array((0, len(rig.skeleton.names))), seconds=seconds)
    return Bound(binding, Influences(falloff, wide.rows))


MOST = 8
"""Influences that a vertex is measured for, and the most that can be chosen."""


def build_shown(inputs: tuple[Any, ...], progress: Progress = silent) -> CutCellGraph:
    """Return the graph that `Choices.graph_inputs` describe."""
    mesh, resolution, connectivity, threshold, orient = inputs
    options = {"connectivity": connectivity, "winding_threshold": threshold, "orient": orient}
    return cutcell.build_graph(mesh, resolution, **options, progress=progress)
