"""All steps of a binding in one call."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Unpack

from ..binding import Binding, binding_steps
from ..errors import SkeletonError
from ..geodesics import BoneDistances
from ..geodesics.bone_extents.skins import method_per_character
from ..graph import CutCellGraph
from ..graph.fingerprint import graph_fingerprint, require_same
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
from .binding_warnings import binding_warnings
from .correct import adjustments_of, corrected_rig, correction_steps, joints_measured
from .corrections import Corrections
from .refine import RefineOptions

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
    corrections: Corrections | None = None,
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
        See `refine_weights`.
    corrections : Corrections, optional
        Manual corrections: joints without weight, locked or with another gain or radius, parts
        bound to joints, weights of single vertices.
    graph : CutCellGraph, optional
        Graph of another binding of the same mesh by the same method, `binding.graph`. It does not
        depend on the skeleton and is reused.
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
    _check(rig, method)
    if graph is None and resolution is None:
        method = method_per_character(rig, method)
    elif graph is not None:
        require_same("graph", graph.fingerprint, graph_fingerprint(rig.mesh, method))
    steps = bind_steps(
        rig, method, corrections, graph, smoothing=smoothing, symmetric=symmetric, locked=locked
    )
    if not is_compiled():
        progress("compile", 0.0)
        warm_up()
        progress("compile", 1.0)

    def work(report: Progress) -> Binding:
        context = run(steps, Context(method, rig.allowed, report))
        return finished(rig, context, corrections, locked)

    return cancellable(work, progress, "graph" if graph is None else "distances")


def bind_steps(
    rig: Rig,
    method: Method,
    corrections: Corrections,
    graph: CutCellGraph | None = None,
    distances: BoneDistances | None = None,
    **refinement: Unpack[RefineOptions],
) -> list[Step]:
    """List the steps of `bind` for a rig that is corrected already; check the refinement.

    A given graph, or given distances, are taken instead of new ones.
    """

    def adjust(context: Context) -> Adjustments | None:
        context.report(0.0)
        return adjustments_of(rig, context.graph, corrections)

    nearest, within = joints_measured(corrections, method)
    build, measure, *weigh = binding_steps(rig, method, graph, distances, nearest, within)
    corrected = correction_steps(rig, corrections, **refinement)
    return [build, measure, Step("adjustments", adjust, "adjustments"), *weigh, *corrected]


def weighed_again(
    rig: Rig,
    binding: Binding,
    corrections: Corrections,
    max_influences: int,
    **refinement: Unpack[RefineOptions],
) -> Binding:
    """Compute the weights of a binding again with at most the given number of influences."""
    method = replace(binding.method, max_influences=max_influences)
    steps = bind_steps(rig, method, corrections, distances=binding.distances, **refinement)
    context = Context(method, rig.allowed, seconds=dict(binding.seconds))
    return finished(rig, run(steps, context), corrections, refinement.get("locked", ()))


def finished(
    rig: Rig, context: Context, corrections: Corrections, locked: Sequence[int | str] = ()
) -> Binding:
    """Return the binding that the steps have computed, with its warnings."""
    context.report(1.0)
    weights, distances = context.weights, context.distances
    warnings = binding_warnings(rig, distances, weights, corrections, locked)
    return Binding(weights, context.graph, distances, context.seconds, warnings, context.method)


def _check(rig: Rig, method: Method) -> None:
    """Raise the errors of graph and distances before the first step begins."""
    Lattice.around(rig.mesh, method.resolution)
    rig.require_joints()
    check_positions(rig.skeleton.joints, "joint", SkeletonError)
    check_matrix(len(rig.mesh.vertices), len(rig.skeleton.joints), COPIES)
