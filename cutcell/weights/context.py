"""The steps of a binding: one list, one context that they share, and the loop over them."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass, field
from time import perf_counter
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array

from ..geodesics import BoneDistances
from ..graph import CutCellGraph
from ..method import Method
from ..runtime.progress import Progress, silent
from .adjustments import Adjustments
from .rig_falloff.diffusion import Diffusion
from .rig_falloff.division import Division
from .rig_falloff.surface_operators import SurfaceOperators

PENDING: Any = None
"""Value of results that no step has computed yet."""
STAGES = ("graph", "distances")
"""Steps whose time is measured separately; all others belong to the stage "weights"."""


@dataclass(eq=False, repr=False)
class Context:
    """The inputs of the steps, and their results so far.

    Parameters
    ----------
    method : Method
    allowed : array, shape (n, j), bool, or None
        Which joints each vertex may follow.
    progress : callable
    graph : CutCellGraph
    distances : BoneDistances
    adjustments : Adjustments or None
    surface : SurfaceOperators or None
        Operators of the graph's mesh; computed when left out.
    division : Division
        The surface divided among the joints. The paper's falloff has none.
    diffusion : Diffusion
        Diffusion over the surface. The paper's falloff has none.
    weights : csr_array, shape (k, j) or (n, j)
    is_per_vertex : bool
        True if `weights` has a row for each vertex instead of each welded vertex.
    seconds : dict of str to float
        Time taken by each stage.
    scaled : bool
        False to keep the largest weights of each vertex as they are: then fewer can be kept later,
        and scaled, with the very result of keeping fewer at once.
    """

    method: Method
    allowed: NDArray[np.bool_] | None = None
    progress: Progress = silent
    graph: CutCellGraph = PENDING
    distances: BoneDistances = PENDING
    adjustments: Adjustments | None = None
    surface: SurfaceOperators | None = None
    division: Division = PENDING
    diffusion: Diffusion = PENDING
    weights: csr_array = PENDING
    is_per_vertex: bool = False
    seconds: dict[str, float] = field(default_factory=dict)
    scaled: bool = True

    def report(self, done: float) -> None:
        """Report the fraction of the stage "weights" that is done."""
        self.progress("weights", done)

    def operators(self) -> SurfaceOperators:
        """Return the operators of the graph's mesh, computed once."""
        if self.surface is None:
            self.surface = SurfaceOperators.of(self.graph)
        return self.surface


class Step(NamedTuple):
    """A step: `run` returns the new value of the field `result` of the context."""

    name: str
    run: Callable[[Context], Any]
    result: str = "weights"


def run(
    steps: Iterable[Step], context: Context, after: Callable[[Step], None] = lambda step: None
) -> Context:
    """Run steps one after the other, and call `after` when each is done; return the context."""
    for step in steps:
        begin = perf_counter()
        setattr(context, step.result, step.run(context))
        stage = step.name if step.name in STAGES else "weights"
        context.seconds[stage] = context.seconds.get(stage, 0.0) + perf_counter() - begin
        after(step)
    return context
