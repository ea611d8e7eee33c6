"""Warnings about a binding, as sentences."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import replace
from weakref import WeakKeyDictionary

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array

from ..editing.edits import Edits
from ..editing.layers import RigSources, vertices_of
from ..editing.layers.contents import Attached, Filled, Locked
from ..editing.layers.layer import Layer
from ..editing.layers.painted import Painted
from ..editing.locks import locked_joints
from ..errors import LocatedWarning
from ..geodesics import FALLBACK_REASONS, BoneDistances
from ..geometry.segments import distance_to_segment
from ..graph import CutCellGraph
from ..method import ANIMATION, MAX_RESOLUTION
from ..pose.stretch import MAX_SHARE, STRETCH_DEGREES, Stretch
from ..rig import Rig
from ..runtime.display import count, listed, share, shown_name
from .binding import Binding

FINDINGS = {1: "unused-vertices", 2: "unreachable-vertices"}
"""Findings of vertices by the reason why no path reaches them."""
BONE_CELLS = 1.5
"""Lattice cells that a bone must be long to have nodes of its own."""
NEAR_BONE = 200
"""Vertices that are compared with all bones."""
Shown = (Filled, Attached, Painted)
"""Contents that a person has chosen the joints of."""
SAME_WEIGHT = 1e-6
"""Weights that differ by less are the same: files round them."""
_finer: WeakKeyDictionary[BoneDistances, dict[bytes, int]] = WeakKeyDictionary()
"""Resolutions that bones need, by which joints have no weight: edits of layers seldom change it."""


def with_warnings(rig: Rig, binding: Binding, edits: Edits) -> Binding:
    """Return a binding with warnings about its weights and the data they were computed from."""
    warned = replace(binding, warnings=warnings_of(rig, binding, edits))
    vars(warned)["stretch"] = binding.stretch  # not measured again
    return warned


def warnings_of(rig: Rig, binding: Binding, edits: Edits) -> tuple[str, ...]:
    """Return warnings about weights and the data they were computed from."""
    distances = binding.distances
    return (
        *_of_distances(distances),
        *_inferred_bones(rig, distances),
        *_weightless(rig, distances, binding.rows),
        *_stretches(rig, binding.stretch),
        *_blocked_by_locks(rig, distances.graph, edits.layers),
    )


def _of_distances(distances: BoneDistances) -> Iterator[str]:
    graph = distances.graph
    if inverted := int(graph.inverted.sum()):
        yield LocatedWarning(
            f"{inverted:,} of {len(graph.inverted):,} faces are inside out and count as turned "
            "round; the mesh itself stays as it is",
            "inverted-faces",
        )
    for reason, text in enumerate(FALLBACK_REASONS[1:], start=1):
        if some := int((distances.fallback == reason).sum()):
            yield LocatedWarning(
                f"{some:,} of {len(distances.fallback):,} vertices follow their nearest bones "
                f"in a straight line: {text}",
                FINDINGS.get(reason, ""),
            )
    if not (graph.node_kind == 1).any():
        yield LocatedWarning(
            "no lattice point lies inside the mesh, distances run over its surface alone: it is "
            "open, or thinner than a lattice cell. Try a higher resolution",
            "no-interior",
        )


def _inferred_bones(rig: Rig, distances: BoneDistances) -> Iterator[str]:
    names, pairs = rig.skeleton.names, distances.bones.inferred
    if pairs:
        bones = listed([f"{names[a]} to {names[b]}" for a, b in pairs])
        yield (
            f"{len(pairs)} bones were inferred, which the file does not have: {bones}. "
            "To leave one out, make its second joint a child of the joint that it belongs to"
        )


def _weightless(rig: Rig, distances: BoneDistances, weights: csr_array) -> Iterator[str]:
    deform = rig.skeleton.deform
    weightless = deform & (weights.sum(axis=0) == 0)
    if weightless.any():
        remembered, key = _finer.setdefault(distances, {}), weightless.tobytes()
        if key not in remembered:
            remembered[key] = _finer_resolution(distances, weightless)
        finer = remembered[key]
        yield (
            f"{weightless.sum()} of {deform.sum()} joints that deform get no weight: "
            f"{rig.skeleton.listed(weightless)}"
            + f". Bones are shorter than a lattice cell: choose a resolution of {finer}"
            * (finer > 0)
        )


def _finer_resolution(distances: BoneDistances, joints: NDArray[np.bool_]) -> int:
    """Return the resolution that the bones of some joints (j,) need; 0 if it does not decide.

    Bones far shorter than a lattice cell begin at the same nodes. One that no vertex is nearest
    to gets no weight at any resolution.
    """
    bones, graph, needed = distances.bones, distances.graph, 0.0
    points = graph.nodes[: graph.first_point]
    cells = BONE_CELLS / np.maximum(np.linalg.norm(bones.end - bones.start, axis=1), 1e-9)
    is_short = (cells > graph.lattice.resolution) & (cells <= MAX_RESOLUTION)
    for b in np.flatnonzero(is_short & joints[bones.joint]):
        away = distance_to_segment(points, bones.start[b], bones.end[b])
        near = points[np.argsort(away, kind="stable")[:NEAR_BONE], None]
        if (distance_to_segment(near, bones.start, bones.end).argmin(axis=1) == b).any():
            needed = max(needed, cells[b])
    return math.ceil(needed / 16) * 16


def _stretches(rig: Rig, stretch: Stretch) -> Iterator[str]:
    """Report a surface of which much stretches as joints turn."""
    if stretch.share > MAX_SHARE and stretch.joint is not None:
        place = ", ".join(f"{value:.3g}" for value in stretch.position or ())
        name = shown_name(rig.skeleton.names[stretch.joint])
        yield LocatedWarning(
            f"{share(stretch.share, 1)} of the surface stretches or shrinks to more than twice "
            f'when joints turn by {STRETCH_DEGREES:g}°, most of it with "{name}", worst '
            f"at vertex {stretch.vertex} (at {place} in file units). Check which joints deform "
            "near there, or bind that part separately",
            "stretched-surface",
        )


def _blocked_by_locks(rig: Rig, graph: CutCellGraph, layers: Sequence[Layer]) -> Iterator[str]:
    """Report layers without effect where joints locked above them keep the file's weights."""
    if rig.weights is None:
        return
    for number, layer in enumerate(layers):
        above = [one.content for one in layers[number + 1 :] if one.is_active]
        locked = [name for one in above if isinstance(one, Locked) for name in one.joints]
        if not locked or not layer.is_active or not isinstance(layer.content, Shown):
            continue
        is_locked = locked_joints(rig, locked)
        sources = RigSources(rig, ANIMATION, graph)
        which = vertices_of(layer.mask, sources.component)
        if isinstance(layer.content, Attached):
            which = np.arange(len(rig.weights)) if which is None else which
            rows = np.zeros((len(which), int(is_locked.sum())))
        else:
            which, some = sources.rows(layer, rig.weights, which)
            rows = np.asarray(some[:, np.flatnonzero(is_locked)].todense())
        differs = np.abs(rig.weights[which][:, is_locked] - rows) > SAME_WEIGHT
        keeping = is_locked.copy()
        keeping[is_locked] = differs.any(axis=0)
        if keeping.any():
            place = "" if layer.mask.part is None else f" on the part of vertex {layer.mask.part}"
            names = listed([f'"{shown_name(name)}"' for name in layer.content.joints_named()])
            to = f" ({names})" if names and not isinstance(layer.content, Painted) else ""
            yield (
                f'the layer "{layer.title}"{place}{to} has no effect at '
                f"{count(int(differs.any(axis=1).sum()), 'vertex')}: these joints are locked "
                f"above it and keep the file's weights there: {rig.skeleton.listed(keeping)}"
            )
