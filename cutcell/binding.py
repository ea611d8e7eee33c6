"""All stages in one call: the only place that composes them."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from time import perf_counter
from typing import Any, Unpack

import numpy as np
from numpy.typing import NDArray

from .editing.binding_warnings import binding_warnings
from .editing.correct import (
    adjustments_of,
    apply_overrides,
    corrected_parts,
    corrected_rig,
    joints_measured,
    locked_by,
)
from .editing.corrections import Corrections
from .editing.refine import RefineOptions, check_refinement, refine_weights
from .errors import SkeletonError
from .geodesics import BoneDistances, bone_distances
from .geodesics.bone_extents.skins import method_per_character
from .graph import CutCellGraph, build_graph
from .graph.fingerprint import graph_fingerprint, require_same
from .graph.lattice import Lattice
from .method import ANIMATION, Method, MethodName, Options, method_of
from .rig import Rig
from .rig.checks import check_positions
from .rig.inputs import RigLike, as_rig
from .runtime.memory import check_matrix
from .runtime.progress import Progress, silent
from .runtime.repr import Summarized
from .runtime.threads import cancellable, submit
from .weights.rig_falloff.surface_operators import SurfaceOperators
from .weights.skinning_weights import skinning_weights
from .weights.warm_up import is_compiled, warm_up

COPIES = 4
"""Matrices of vertices and joints that there are at a time, distances and weights, at most."""


@dataclass(frozen=True, eq=False, repr=False)
class Binding(Summarized):
    """A bound rig: weights, and everything they came from.

    Parameters
    ----------
    weights : array, shape (n, j), float64
        For the rig's own vertices, in their order.
    graph : CutCellGraph
    distances : BoneDistances
        From as many of each vertex' nearest joints as the falloff needs.
    seconds : dict of str to float
        Time taken by each stage: "graph", "distances", "weights".
    warnings : tuple of str
        What a person should know about the result, in sentences.
    method : Method
        What computed it.
    """

    weights: NDArray[np.float64]
    graph: CutCellGraph
    distances: BoneDistances
    seconds: dict[str, float]
    warnings: tuple[str, ...]
    method: Method

    @property
    def _summary(self) -> dict[str, Any]:
        vertices, joints = self.weights.shape
        return {
            "method": self.method.name,
            "resolution": self.method.resolution,
            "vertices": vertices,
            "joints": joints,
            "nodes": len(self.graph.nodes),
            "edges": len(self.graph.edges),
            "unreached_vertices": int(np.count_nonzero(self.distances.fallback)),
            "seconds": round(sum(self.seconds.values()), 2),
            "warnings": len(self.warnings),
        }


def bind(
    rig: RigLike,
    resolution: int | None = None,
    *,
    method: Method | MethodName = ANIMATION,
    smoothing: int = 0,
    symmetric: bool = False,
    locked: Sequence[int | str] = (),
    corrections: Corrections | None = None,
    graph: CutCellGraph | None = None,
    progress: Progress = silent,
    **options: Unpack[Options],
) -> Binding:
    """Compute skinning weights for a rig.

    It is the stages one after the other, each with the same method: `build_graph`,
    `bone_distances`, `skinning_weights`, and last `refine_weights`.

    Parameters
    ----------
    rig : Rig, (mesh, skeleton) or (vertices, faces, joints, parents)
        The mesh may be of any kind that `build_graph` takes. A rig's own weights are not used,
        except that joints without any stay without (`Skeleton.deform`).
    resolution : int, optional
        R, 2 to 1024; the method's when left out. That counts along the largest character where
        the file has several, side by side, so that each is bound as if it were alone.
    method : Method, "animation" or "paper"
        How weights are computed. `cutcell.ANIMATION` is made to animate with, `cutcell.PAPER` is
        the paper's method.
    smoothing, symmetric, locked
        See `refine_weights`.
    corrections : Corrections, optional
        What a person corrects: joints without weight, locked or of another reach, parts that are
        glued, single vertices.
    graph : CutCellGraph, optional
        That of another binding of the same mesh by the same method, `binding.graph`: it does not
        depend on the skeleton. What only depends on it is then not computed again.
    progress : callable
        See `cutcell.runtime.progress`; stages are "graph", "distances", "weights", and
        before them "compile" the very first time on a machine, and after a change of the code.
    **options
        Single options on top of the method, see `Method`: `connectivity`, `winding_threshold`,
        `orient`, `samples`, `leaf`, `falloff`, `refine`, `alpha`,
        `max_influences`, `threshold`.

    Returns
    -------
    Binding

    Raises
    ------
    ParameterError
        A parameter is out of its range, or has no effect; the graph is of another mesh or method.
    MeshError, SkeletonError, WeightsError
        The rig cannot be bound; the sentence says why.

    Examples
    --------
    >>> rig = cutcell.load("character.glb")  # doctest: +SKIP
    >>> binding = cutcell.bind(rig)  # doctest: +SKIP
    >>> cutcell.save("bound.glb", rig.with_weights(binding.weights))  # doctest: +SKIP
    >>> again = cutcell.bind(moved, graph=binding.graph)  # other joints  # doctest: +SKIP
    >>> cutcell.bind((vertices, faces, joints, parents), method="paper")  # doctest: +SKIP
    """
    rig = as_rig(rig)
    method = method_of(method, resolution, **options)
    corrections = Corrections() if corrections is None else corrections
    rig = corrected_rig(rig, corrections)
    if corrections.joints:
        locked = [*locked, *locked_by(corrections)]
    refinement: RefineOptions = {"smoothing": smoothing, "symmetric": symmetric, "locked": locked}
    _check(rig, method, refinement)
    if graph is None and resolution is None:
        method = method_per_character(rig, method)
    elif graph is not None:
        require_same("graph", graph.fingerprint, graph_fingerprint(rig.mesh, method))
    if not is_compiled():
        progress("compile", 0.0)
        warm_up()
        progress("compile", 1.0)
    first_stage = "graph" if graph is None else "distances"

    def work(report: Progress) -> Binding:
        return _bind(rig, method, corrections, refinement, graph, report)

    return cancellable(work, progress, first_stage)


def _bind(
    rig: Rig,
    method: Method,
    corrections: Corrections,
    refinement: RefineOptions,
    graph: CutCellGraph | None,
    progress: Progress,
) -> Binding:
    """Run the stages."""
    seconds: dict[str, float] = {}
    with _timed("graph", seconds):
        if graph is None:
            graph = build_graph(rig.mesh, method=method, progress=progress)
    with _timed("distances", seconds):
        # Another thread computes what the weights need of the surface.
        is_rig = method.falloff == "rig"
        surface = submit(lambda: SurfaceOperators.of(graph)) if is_rig else None
        nearest, within = joints_measured(corrections, method)
        distances = bone_distances(
            graph,
            rig.skeleton,
            method=method,
            nearest_joints=nearest,
            within=within,
            allowed=rig.allowed,
            progress=progress,
        )
    with _timed("weights", seconds):
        progress("weights", 0.0)
        weights = skinning_weights(
            distances,
            method=method,
            allowed=rig.allowed,
            adjustments=adjustments_of(rig, graph, corrections),
            surface=surface() if surface else None,
            progress=progress,
        )
        weights = corrected_parts(rig, graph, weights, corrections)
        weights = refine_weights(rig, weights, method=method, **refinement)
        weights = apply_overrides(rig, graph, weights, corrections, refinement["locked"])
        progress("weights", 1.0)
    warnings = binding_warnings(rig, distances, weights, corrections, refinement["locked"])
    return Binding(weights, graph, distances, seconds, warnings, method)


def _check(rig: Rig, method: Method, refinement: RefineOptions) -> None:
    """Refuse what a stage would refuse, before the first one has begun."""
    Lattice.around(rig.mesh, method.resolution)
    rig.require_joints()
    check_positions(rig.skeleton.joints, "joint", SkeletonError)
    check_refinement(rig, **refinement)
    check_matrix(len(rig.mesh.vertices), len(rig.skeleton.joints), COPIES)


@contextmanager
def _timed(stage: str, seconds: dict[str, float]) -> Iterator[None]:
    begin = perf_counter()
    yield
    seconds[stage] = perf_counter() - begin
