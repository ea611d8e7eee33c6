"""All stages in one call: the only place that composes them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from time import perf_counter

import numpy as np
from numpy.typing import NDArray

from ..checks import check_choice, check_has_joints, check_integer, check_number, check_positions
from ..errors import SkeletonError
from ..geodesics import FALLBACK_REASONS, LEAVES, BoneDistances, bone_distances
from ..geodesics.distances import MOST_SAMPLES
from ..graph import CutCellGraph, build_graph
from ..graph.lattice import Lattice
from ..memory import check_matrix
from ..progress import Progress, silent
from ..rig import Rig
from ..threads import meanwhile
from .kernels import kernels_are_compiled, load_kernels
from .refine import check_refinement, refine_weights
from .skin import Skin
from .weights import (
    DEFAULT_LEAF,
    FALLOFFS,
    check_pruning,
    joints_needed,
    reach_needed,
    skinning_weights,
)

COPIES = 4
"""Matrices of vertices and joints that there are at a time, distances and weights, at most."""


@dataclass(frozen=True, eq=False)
class Binding:
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
    """

    weights: NDArray[np.float64]
    graph: CutCellGraph
    distances: BoneDistances
    seconds: dict[str, float]
    warnings: tuple[str, ...]


def bind(
    rig: Rig,
    resolution: int = 64,
    *,
    connectivity: int | str = "any",
    winding_threshold: float = 0.5,
    orient: bool = True,
    samples: int = 5,
    leaf: str | None = None,
    falloff: str = "rig",
    alpha: float = 0.5,
    max_influences: int | None = 4,
    threshold: float = 0.0,
    smoothing: int = 0,
    symmetric: bool = False,
    locked: Sequence[int | str] = (),
    progress: Progress = silent,
) -> Binding:
    """Compute skinning weights for a rig.

    Parameters
    ----------
    rig : Rig
        Its own weights are not used, except that joints without any stay without
        (`Skeleton.deform`).
    resolution, connectivity, winding_threshold, orient
        See `build_graph`. The default measures geodesic distances; connectivity 6 is the
        paper's, whose paths inside follow the axes.
    samples, leaf
        See `bone_distances`. Left out, `leaf` is what the falloff is made for: "fit" for
        "rig", "point" for "paper".
    falloff, alpha, max_influences, threshold
        See `skinning_weights`.
    smoothing, symmetric, locked
        See `refine_weights`.
    progress : callable
        See `cutcell.progress`; stages are "graph", "distances", "weights", and
        before them "compile" the very first time on a machine, and after a change of the code.

    Returns
    -------
    Binding

    Raises
    ------
    ParameterError
        A parameter is out of its range.
    MeshError, SkeletonError, WeightsError
        The rig cannot be bound; the sentence says why.

    Examples
    --------
    >>> rig = cutcell.load("character.glb")  # doctest: +SKIP
    >>> binding = cutcell.bind(rig)  # doctest: +SKIP
    >>> cutcell.save("bound.glb", rig.with_weights(binding.weights))  # doctest: +SKIP
    """
    # Each stage checks what it is given, but that would be late for the last.
    Lattice.around(rig.mesh, resolution)
    samples = check_integer("samples", samples, 1, MOST_SAMPLES)
    falloff = check_choice("falloff", falloff, FALLOFFS)
    leaf = DEFAULT_LEAF[falloff] if leaf is None else check_choice("leaf", leaf, LEAVES)
    alpha = check_number("alpha", alpha, 0, 1)
    max_influences, threshold = check_pruning(max_influences, threshold)
    check_has_joints(rig.skeleton)
    check_positions(rig.skeleton.joints, "joint", SkeletonError)
    check_refinement(rig, smoothing, symmetric, locked)
    check_matrix(len(rig.mesh.vertices), len(rig.skeleton.joints), COPIES)
    if not kernels_are_compiled():
        progress("compile", 0.0)
        load_kernels()
        progress("compile", 1.0)
    ticks = [perf_counter()]
    graph = build_graph(
        rig.mesh,
        resolution,
        winding_threshold=winding_threshold,
        connectivity=connectivity,
        orient=orient,
        progress=progress,
    )
    ticks.append(perf_counter())
    if connectivity == "any":
        graph.begin_contracting()
    skin = meanwhile(lambda: Skin.of(graph)) if falloff == "rig" else None
    distances = bone_distances(
        graph,
        rig.skeleton,
        samples=samples,
        leaf=leaf,
        nearest_joints=joints_needed(falloff, max_influences),
        within=reach_needed(falloff),
        allowed=rig.allowed,
        progress=progress,
    )
    ticks.append(perf_counter())
    progress("weights", 0.0)
    weights = skinning_weights(
        distances,
        falloff=falloff,
        alpha=alpha,
        max_influences=max_influences,
        threshold=threshold,
        allowed=rig.allowed,
        skin=skin and skin(),
        progress=progress,
    )
    weights = refine_weights(
        rig,
        weights,
        smoothing=smoothing,
        symmetric=symmetric,
        locked=locked,
        max_influences=max_influences,
        threshold=threshold,
    )
    progress("weights", 1.0)
    ticks.append(perf_counter())
    seconds = dict(zip(("graph", "distances", "weights"), np.diff(ticks).tolist(), strict=True))
    return Binding(weights, graph, distances, seconds, _warnings(graph, distances))


def _warnings(graph: CutCellGraph, distances: BoneDistances) -> tuple[str, ...]:
    found = []
    inverted = int(graph.inverted.sum())
    if inverted:
        found.append(
            f"{inverted} of {len(graph.inverted)} faces are inside out and count as turned round; "
            "the mesh itself stays as it is"
        )
    for reason, text in enumerate(FALLBACK_REASONS[1:], start=1):
        count = int((distances.fallback == reason).sum())
        if count:
            found.append(
                f"{count} of {len(distances.fallback)} vertices follow their nearest bones "
                f"in a straight line: {text}"
            )
    if not (graph.node_kind == 1).any():
        found.append(
            "no lattice point lies inside the mesh, distances run over its surface alone: it is "
            "open, or thinner than a lattice cell. Try a higher resolution"
        )
    return tuple(found)
