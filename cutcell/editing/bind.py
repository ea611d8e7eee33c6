"""All steps of a binding in one call."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import Unpack

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array

from ..binding import Binding, binding_steps
from ..errors import SkeletonError
from ..geodesics import BoneDistances
from ..geodesics.bone_extents.skins import method_per_character
from ..graph import CutCellGraph, build_graph
from ..graph.fingerprint import differences, distance_fingerprint, graph_fingerprint, require_same
from ..graph.lattice import Lattice
from ..method import ANIMATION, Method, MethodName, Options, method_of
from ..rig import Rig
from ..rig.checks import check_positions
from ..rig.inputs import RigLike, as_rig
from ..runtime.memory import check_matrix
from ..runtime.progress import Progress, silent
from ..runtime.threads import cancellable
from ..weights.adjustments import Adjustments
from ..weights.context import Context, Step, run
from ..weights.warm_up import is_compiled, warm_up
from .binding_warnings import with_warnings
from .edited import adjustments_of, edited_rig, joints_measured
from .edits import Edits
from .layers import RigSources, apply_layers, vertices_of
from .layers.contents import Computed
from .layers.layer import Layer
from .refine import RefineOptions, refinement

COPIES = 4
"""Maximum number of matrices of vertices and joints, distances and weights, at a time."""


def bind(
    rig: RigLike,
    resolution: int | None = None,
    *,
    method: Method | MethodName = ANIMATION,
    smoothing: int = 0,
    symmetric: bool = False,
    locked: Sequence[int | str] = (),
    edits: Edits | None = None,
    graph: CutCellGraph | None = None,
    progress: Progress = silent,
    **options: Unpack[Options],
) -> Binding:
    """Compute skinning weights for a rig.

    It runs `build_graph`, `bone_distances`, `skinning_weights` and `refine_weights`, each with the
    same method.

    Parameters
    ----------
    rig : Rig, (mesh, skeleton) or (vertices, faces, joints, parents)
        The mesh may be of any kind that `build_graph` takes. A rig's own weights are not used,
        except that joints without any stay without (`Skeleton.deform`).
    resolution : int, optional
        R, 2 to 1024; the method's when left out. That counts along the largest character where
        the file has several, side by side, so that each is bound as if it were alone.
    method : Method, "animation" or "paper"
        Options of the method. `cutcell.ANIMATION` is for animation, `cutcell.PAPER` is the paper's
        method.
    smoothing, symmetric, locked
        See `refine_weights`; they are layers below all others.
    edits : Edits, optional
        What a person changed: joints, and layers over computed weights or over the file's. Its own
        `method` is not used; see `cutcell.Edits`.
    graph : CutCellGraph, optional
        Graph of another binding of the same mesh by the same method, `binding.graph`. It does not
        depend on the skeleton and is reused.
    progress : callable
        See `cutcell.runtime.progress`; stages are "graph", "distances", "weights", and
        before them "compile" the very first time on a machine, and after a change of the code.
    **options
        Single options on top of the method, see `Method`: `connectivity`, `winding_threshold`,
        `orient`, `samples`, `leaf`, `falloff`, `alpha`,
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
    edits = Edits() if edits is None else edits
    rig = edited_rig(rig, edits)
    _check(rig, method)
    if resolution is None:
        method = method_per_character(rig, method, graph)
    if graph is not None:
        require_same("graph", graph.fingerprint, graph_fingerprint(rig.mesh, method))
    steps = bind_steps(
        rig, method, edits, graph, smoothing=smoothing, symmetric=symmetric, locked=locked
    )
    if not is_compiled():
        progress("compile", 0.0)
        warm_up()
        progress("compile", 1.0)

    def work(report: Progress) -> Binding:
        context = run(steps, Context(method, rig.allowed, report))
        return finished(rig, context, edits)

    return cancellable(work, progress, "graph" if graph is None else "distances")


def bind_steps(
    rig: Rig,
    method: Method,
    edits: Edits,
    graph: CutCellGraph | None = None,
    distances: BoneDistances | None = None,
    after: Callable[[Layer, NDArray[np.float64]], None] = lambda layer, weights: None,
    **refinements: Unpack[RefineOptions],
) -> list[Step]:
    """List the steps of `bind` for a rig that is edited already; check the refinements.

    A given graph, or given distances, are taken instead of new ones. See `apply_layers` for
    `after`.
    """
    layers = edits.stack(refinement(rig, **refinements))

    def apply(context: Context) -> csr_array:
        def computed(layer: Layer) -> NDArray[np.float64]:
            return layer_context(rig, context, edits.reach, layer).weights.toarray()

        sources = RigSources(rig, method, context.graph, context.operators, computed)
        return csr_array(apply_layers(context.weights.toarray(), layers, sources, after))

    steps = computed_steps(rig, method, edits.reach, graph, distances)
    return [*steps, *([Step("layers", apply)] if layers else [])]


def computed_steps(
    rig: Rig,
    method: Method,
    content: Computed,
    graph: CutCellGraph | None = None,
    distances: BoneDistances | None = None,
    vertices: NDArray[np.intp] | None = None,
) -> list[Step]:
    """List the steps from a rig to computed weights, with the reach of joints of a content.

    See `adjustments_of` for the vertices.
    """

    def adjust(context: Context) -> Adjustments | None:
        context.report(0.0)
        return adjustments_of(rig, context.graph, content, vertices)

    nearest, within = joints_measured(content, method)
    build, measure, *weigh = binding_steps(rig, method, graph, distances, nearest, within)
    return [build, measure, Step("adjustments", adjust, "adjustments"), *weigh]


def layer_context(rig: Rig, context: Context, reach: Computed, layer: Layer) -> Context:
    """Compute the weights of a layer whose content is computed; return all results.

    The context is that of the other weights, which were computed with the reach of joints of
    `reach`; its graph and its distances are used where they fit.
    """
    content, graph, distances = layer.content, context.graph, None
    assert isinstance(content, Computed)
    method = content.method(context.method)
    vertices = vertices_of(layer.mask, RigSources(rig, method, graph).component)
    if graph.fingerprint != graph_fingerprint(rig.mesh, method):
        graph = build_graph(rig.mesh, method=method, progress=context.progress)
    else:
        expected = distance_fingerprint(rig.skeleton, method, rig.allowed)
        is_same = not differences(context.distances.fingerprint, expected)
        if is_same and joints_measured(content, method) == joints_measured(reach, context.method):
            distances = context.distances
    steps = computed_steps(rig, method, content, graph, distances, vertices)
    return run(steps, Context(method, rig.allowed, context.progress, scaled=context.scaled))


def weighed_again(
    rig: Rig,
    binding: Binding,
    edits: Edits,
    max_influences: int,
    **refinements: Unpack[RefineOptions],
) -> Binding:
    """Compute the weights of a binding again with at most the given number of influences."""
    method = replace(binding.method, max_influences=max_influences)
    steps = bind_steps(rig, method, edits, distances=binding.distances, **refinements)
    context = Context(method, rig.allowed, seconds=dict(binding.seconds))
    return finished(rig, run(steps, context), edits)


def finished(rig: Rig, context: Context, edits: Edits) -> Binding:
    """Return the binding that the steps have computed, with its warnings."""
    context.report(1.0)
    results = context.weights, context.graph, context.distances, context.seconds
    return with_warnings(rig, Binding(*results, (), context.method), edits)


def _check(rig: Rig, method: Method) -> None:
    """Raise the errors of graph and distances before the first step begins."""
    Lattice.around(rig.mesh, method.resolution)
    rig.require_joints()
    check_positions(rig.skeleton.joints, "joint", SkeletonError)
    check_matrix(len(rig.mesh.vertices), len(rig.skeleton.joints), COPIES)
