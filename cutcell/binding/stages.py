"""The stages of a binding: graph, distances, weights, and the layers over them."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import replace
from time import perf_counter

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array

from ..animation.falloff.surface_operators import surface_of
from ..editing.edited import adjustments_of, joints_measured
from ..editing.edits import Edits
from ..editing.layers import RigSources, apply_layers, vertices_of
from ..editing.layers.contents import Computed
from ..editing.layers.layer import Layer
from ..geodesics import BoneDistances, bone_distances
from ..graph import CutCellGraph, build_graph
from ..graph.fingerprint import differences, distance_fingerprint, graph_fingerprint
from ..method import Method
from ..rig import Rig
from ..runtime.progress import Progress, silent
from ..runtime.threads import submit
from ..weights.skinning_weights import last_of, weight_steps
from .binding import Binding
from .warnings import with_warnings


@contextmanager
def timed(seconds: dict[str, float], stage: str) -> Iterator[None]:
    """Add the time that a block takes to the seconds of a stage."""
    began = perf_counter()
    yield
    seconds[stage] = seconds.get(stage, 0.0) + perf_counter() - began


def measure(
    rig: Rig,
    method: Method,
    reach: Computed,
    seconds: dict[str, float],
    graph: CutCellGraph | None = None,
    progress: Progress = silent,
) -> BoneDistances:
    """Compute a graph, unless it is given, and the distances that a reach of joints needs."""
    with timed(seconds, "graph"):
        built = graph or build_graph(rig.mesh, method=method, progress=progress)
    with timed(seconds, "distances"):
        # Another thread computes what the weights need of the surface.
        surface = submit(lambda: surface_of(built).dissection) if method.falloff == "rig" else None
        nearest_joints, within = joints_measured(reach, method)
        distances = bone_distances(
            built,
            rig.skeleton,
            method=method,
            nearest_joints=nearest_joints,
            within=within,
            allowed=rig.allowed,
            progress=progress,
        )
        if surface is not None:
            surface()
    return distances


def bind_base(
    rig: Rig,
    method: Method,
    reach: Computed,
    graph: CutCellGraph | None = None,
    distances: BoneDistances | None = None,
    vertices: NDArray[np.intp] | None = None,
    progress: Progress = silent,
    scaled: bool = True,
) -> Binding:
    """Bind a rig without layers, with the reach of joints of a content.

    A given graph, or given distances, are taken instead of new ones. See `adjustments_of` for the
    vertices, and `weight_steps` for `scaled`.
    """
    seconds: dict[str, float] = {}
    distances = distances or measure(rig, method, reach, seconds, graph, progress)
    progress("weights", 0.0)
    with timed(seconds, "weights"):
        adjustments = adjustments_of(rig, distances.graph, reach, vertices)
        steps = weight_steps(
            distances, method, rig.allowed, adjustments, progress=progress, scaled=scaled
        )
        rows = last_of(steps)
    return Binding(rows, distances.graph, distances, seconds, (), method)


def bind_layer(
    rig: Rig,
    base: Binding,
    reach: Computed,
    layer: Layer,
    progress: Progress = silent,
    scaled: bool = True,
) -> Binding:
    """Compute the weights of a layer whose content is computed.

    The base is the binding below all layers, computed with the reach of joints of `reach`; its
    graph and its distances are used where they fit.
    """
    content, graph, distances = layer.content, base.graph, None
    assert isinstance(content, Computed)
    method = content.method(base.method)
    vertices = vertices_of(layer.mask, RigSources(rig, method, graph).component)
    if graph.fingerprint != graph_fingerprint(rig.mesh, method):
        graph = build_graph(rig.mesh, method=method, progress=progress)
    else:
        expected = distance_fingerprint(rig.skeleton, method, rig.allowed)
        is_same = not differences(base.distances.fingerprint, expected)
        if is_same and joints_measured(content, method) == joints_measured(reach, base.method):
            distances = base.distances
    return bind_base(rig, method, content, graph, distances, vertices, progress, scaled)


def with_layers(
    rig: Rig,
    base: Binding,
    layers: Iterable[Layer],
    computed: Callable[[Layer], NDArray[np.float64]],
    after: Callable[[Layer, NDArray[np.float64]], None] = lambda layer, weights: None,
) -> Binding:
    """Return a binding with layers over its weights.

    `computed` returns the weights (n, j) of a layer with a `Computed` content; see `apply_layers`
    for `after`.
    """
    active = [layer for layer in layers if layer.is_active]
    if not active:
        return base
    sources = RigSources(rig, base.method, base.graph, computed)
    return replace(base, rows=csr_array(apply_layers(base.weights, active, sources, after)))


def bind_edited(
    rig: Rig,
    method: Method,
    edits: Edits,
    lowest: Sequence[Layer] = (),
    graph: CutCellGraph | None = None,
    distances: BoneDistances | None = None,
    progress: Progress = silent,
) -> Binding:
    """Bind a rig whose skeleton is edited already, and apply layers; the lowest go below others."""
    reach = edits.reach
    base = bind_base(rig, method, reach, graph, distances, progress=progress)

    def computed(layer: Layer) -> NDArray[np.float64]:
        return bind_layer(rig, base, reach, layer, progress).weights

    with timed(base.seconds, "weights"):
        binding = with_layers(rig, base, edits.stack(lowest), computed)
    progress("weights", 1.0)
    return with_warnings(rig, binding, edits)
