"""All stages of a binding in one call."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Unpack

from ..editing.edited import edited_rig
from ..editing.edits import Edits
from ..editing.refine import RefineOptions, refinement
from ..errors import SkeletonError
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
from ..weights.warm_up import is_compiled, warm_up
from .binding import Binding
from .resolution import method_per_character
from .stages import bind_edited

MATRICES = 4
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
    lowest = refinement(rig, smoothing, symmetric, locked)
    if not is_compiled():
        progress("compile", 0.0)
        warm_up()
        progress("compile", 1.0)
    return cancellable(
        lambda report: bind_edited(rig, method, edits, lowest, graph, progress=report),
        progress,
        "graph" if graph is None else "distances",
    )


def limit_influences(
    rig: Rig,
    binding: Binding,
    edits: Edits,
    max_influences: int,
    **refinements: Unpack[RefineOptions],
) -> Binding:
    """Compute the weights of a binding again with at most the given number of influences."""
    method = replace(binding.method, max_influences=max_influences)
    lowest = refinement(rig, **refinements)
    limited = bind_edited(rig, method, edits, lowest, distances=binding.distances)
    spent = limited.seconds["weights"] + binding.seconds.get("weights", 0.0)
    return replace(limited, seconds={**binding.seconds, "weights": spent})


def _check(rig: Rig, method: Method) -> None:
    """Raise the errors of graph and distances before the first step begins."""
    Lattice.around(rig.mesh, method.resolution)
    rig.require_joints()
    check_positions(rig.skeleton.joints, "joint", SkeletonError)
    check_matrix(len(rig.mesh.vertices), len(rig.skeleton.joints), MATRICES)
