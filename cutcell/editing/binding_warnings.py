"""Warnings about a binding, as sentences."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np
from numpy.typing import NDArray

from ..geodesics import FALLBACK_REASONS, BoneDistances
from ..graph import CutCellGraph
from ..rig import Rig
from ..runtime.display import listed
from ..weights.rig_falloff.surface_operators import SurfaceOperators
from .correct import locked_by
from .corrections import Corrections
from .locks import joint_index, locked_joints

SAME = 1e-6
"""Weights that differ by less are the same: files round them."""


def binding_warnings(
    rig: Rig,
    distances: BoneDistances,
    weights: NDArray[np.float64],
    corrections: Corrections,
    locked: Sequence[int | str] = (),
) -> tuple[str, ...]:
    """Return warnings about weights and the data that they were computed from.

    Shapes: weights (n, j).
    """
    is_locked = locked_joints(rig, [*locked, *locked_by(corrections)])
    return (
        *_of_distances(distances.graph, distances),
        *_inferred_bones(rig, distances),
        *_weightless(rig, weights),
        *_blocked_by_locks(rig, distances.graph, corrections, is_locked),
    )


def _of_distances(graph: CutCellGraph, distances: BoneDistances) -> Iterator[str]:
    inverted = int(graph.inverted.sum())
    if inverted:
        yield (
            f"{inverted:,} of {len(graph.inverted):,} faces are inside out and count as turned "
            "round; the mesh itself stays as it is"
        )
    for reason, text in enumerate(FALLBACK_REASONS[1:], start=1):
        count = int((distances.fallback == reason).sum())
        if count:
            yield (
                f"{count:,} of {len(distances.fallback):,} vertices follow their nearest bones "
                f"in a straight line: {text}"
            )
    if not (graph.node_kind == 1).any():
        yield (
            "no lattice point lies inside the mesh, distances run over its surface alone: it is "
            "open, or thinner than a lattice cell. Try a higher resolution"
        )


def _inferred_bones(rig: Rig, distances: BoneDistances) -> Iterator[str]:
    names, pairs = rig.skeleton.names, distances.bones.inferred
    if pairs:
        bones = listed([f"{names[a]} to {names[b]}" for a, b in pairs])
        yield (
            f"{len(pairs)} bones were inferred, which the file does not have: {bones}. "
            "To leave one out, make its second joint a child of the joint that it belongs to"
        )


def _weightless(rig: Rig, weights: NDArray[np.float64]) -> Iterator[str]:
    deform = rig.skeleton.deform
    weightless = deform & ~weights.any(axis=0)
    if weightless.any():
        yield (
            f"{weightless.sum()} of {deform.sum()} joints that deform get no weight: "
            f"{_names(rig, weightless)}"
        )


def _blocked_by_locks(
    rig: Rig, graph: CutCellGraph, corrections: Corrections, is_locked: NDArray[np.bool_]
) -> Iterator[str]:
    """Report corrections without effect where locked joints keep the file's weights."""
    if rig.weights is None or not is_locked.any():
        return
    for vertex, part in corrections.parts.items():
        if part.how in ("itself", "file"):
            continue
        component = SurfaceOperators.of(graph).component[graph.vertex_node]
        corrected, binding = np.zeros(len(is_locked)), "follows what it touches"
        if part.joint is not None:
            corrected[joint_index(rig.skeleton, part.joint)] = 1
            binding = f'is glued to "{part.joint}"'
        stored = rig.weights[component == component[vertex]]
        keeping = is_locked & (np.abs(stored - corrected) > SAME).any(axis=0)
        if keeping.any():
            yield (
                f"the part of vertex {vertex} {binding}, but these joints are locked and keep the "
                f"file's weights there: {_names(rig, keeping)}"
            )
    column = {rig.skeleton.names[j]: j for j in np.flatnonzero(is_locked)}
    overrides = np.zeros((len(corrections.vertices), len(is_locked)))
    for row, weights in enumerate(corrections.vertices.values()):
        for name in weights.keys() & column.keys():
            overrides[row, column[name]] = weights[name]
    differs = np.abs(overrides - rig.weights[list(corrections.vertices)]) > SAME
    keeping = is_locked & differs.any(axis=0)
    if keeping.any():
        count = int(differs[:, keeping].any(axis=1).sum())
        yield (
            f"{count} vertices are set by hand, but these joints are locked and keep the file's "
            f"weights there: {_names(rig, keeping)}"
        )


def _names(rig: Rig, which: NDArray[np.bool_]) -> str:
    return listed([rig.skeleton.names[j] for j in np.flatnonzero(which)])
