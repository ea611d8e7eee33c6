"""Explanation of a vertex's weights: paths, distances, and the weights after each step."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from typing import Any, Unpack

import numpy as np
from numpy.typing import NDArray

from ..animation.falloff.pipeline import RigFalloff
from ..checks import check_integer
from ..editing.edited import adjustments_of, edited_rig, joints_measured
from ..editing.edits import Edits
from ..editing.layers.layer import Layer
from ..editing.locks import joint_index
from ..geodesics import FALLBACK_REASONS, PIECES, BoneDistances, trace_path
from ..geodesics.fallback import REACHED
from ..geometry.segments import distance_to_segment
from ..graph.fingerprint import distance_fingerprint, graph_fingerprint, require_same
from ..method import ANIMATION, Method, MethodName, Options, method_of
from ..rig import Rig
from ..rig.inputs import RigLike, as_rig
from ..runtime.progress import Progress, silent
from ..weights.skinning_weights import weight_steps
from .absence import Trace
from .binding import Binding
from .resolution import method_per_character
from .stages import bind_layer, measure, with_layers

SOME = 1e-4
"""Joints that no step gives as much are left out, unless the file has weight of them."""


@dataclass(frozen=True)
class Piece:
    """A straight piece of a path.

    Parameters
    ----------
    kind : str
        One of `geodesics.PIECES`.
    start, end : tuple of 3 floats
        In the file's units.
    length : float
        In the file's units.
    """

    kind: str
    start: tuple[float, float, float]
    end: tuple[float, float, float]
    length: float


@dataclass(frozen=True)
class JointShare:
    """The origin of a vertex's weight of one joint. Lengths are in the file's units.

    Parameters
    ----------
    joint : int
    name : str
    path : tuple of Piece
        From the vertex to the joint's bones; empty where none leads through the body.
    distance : float
        Distance that the weights are computed from; infinite if the joint is not among the nearest.
    straight : float
        The distance through the air.
    factors : dict of str to float
        Factors of the distance in the falloff for rigs: "component", if the bone is in
        another component; "radius", if the vertex is beyond the bone's radius; "facing", if the
        surface looks at the bone rather than away from it. The paper's has none. With either,
        "gain", if a layer gives the joint one.
    effective : float
        The distance times all factors: shares fall with it.
    steps : dict of str to float
        The weight after each step: keys of `STEPS` in their order, then the titles of layers.
    weight : float
        After the last.
    file_weight : float or None
        Weight in the file.
    rank : int or None
        1 for the nearest joint; None without a path.
    absence : str
        Why the joint has no weight, in a sentence; empty if it has some.
    """

    joint: int
    name: str
    path: tuple[Piece, ...]
    distance: float
    straight: float
    factors: dict[str, float]
    effective: float
    steps: dict[str, float]
    weight: float
    file_weight: float | None
    rank: int | None
    absence: str


@dataclass(frozen=True)
class Explanation:
    """Explanation of a vertex's weights.

    Parameters
    ----------
    vertex : int
    position : tuple of 3 floats
        In the file's units.
    fallback : str
        Why no path through the body reaches the vertex; empty if one does.
    joints : tuple of JointShare
        Joints with weight after any step or in the file, and the one that is asked for; the
        largest weight first.
    """

    vertex: int
    position: tuple[float, float, float]
    fallback: str
    joints: tuple[JointShare, ...]

    def to_dict(self) -> dict[str, Any]:
        """Return it as plain data; infinite distances are None."""
        return _finite(asdict(self))


def explain(
    rig: RigLike,
    vertex: int,
    resolution: int | None = None,
    *,
    joint: int | str | None = None,
    method: Method | MethodName = ANIMATION,
    edits: Edits | None = None,
    distances: BoneDistances | None = None,
    progress: Progress = silent,
    **options: Unpack[Options],
) -> Explanation:
    """Explain the weights that `bind` computes for a vertex.

    Parameters
    ----------
    rig : Rig, (mesh, skeleton) or (vertices, faces, joints, parents)
    vertex : int
    resolution : int, optional
        R; the method's when left out.
    joint : int or str, optional
        Number or name of a joint to explain even if it has no weight.
    method : Method, "animation" or "paper"
    edits : Edits, optional
        As of `bind`.
    distances : BoneDistances, optional
        Distances of this rig by this method and these edits, such as those of a `Binding`;
        computed when left out.
    progress : callable
        See `cutcell.runtime.progress`; stages are "graph", "distances" and "weights".
    **options
        Single options on top of the method, see `Method`.

    Returns
    -------
    Explanation

    Raises
    ------
    ParameterError
        There is no such vertex or joint, a parameter is out of its range, or the distances are
        of another rig or method.
    MeshError, SkeletonError
        The rig cannot be bound.

    Examples
    --------
    >>> for share in cutcell.explain(rig, 120).joints:  # doctest: +SKIP
    ...     print(share.name, share.distance, share.steps, share.file_weight)
    """
    rig = as_rig(rig)
    method = method_of(method, resolution, **options)
    vertex = check_integer("vertex", vertex, 0, len(rig.mesh.vertices) - 1)
    edits = Edits() if edits is None else edits
    rig = edited_rig(rig, edits)
    if resolution is None:  # as `bind` does
        method = method_per_character(rig, method, None if distances is None else distances.graph)
    if distances is not None:
        expected = graph_fingerprint(rig.mesh, method)
        measured = joints_measured(edits.reach, method)
        expected |= distance_fingerprint(rig.skeleton, method, rig.allowed, *measured)
        require_same("distances", distances.fingerprint, expected)
    else:
        distances = measure(rig, method, edits.reach, {}, progress=progress)
    trace = _traced(rig, vertex, method, edits, distances, progress)
    last, most = trace.last, np.max(list(trace.rows.values()), axis=0)
    own = None if rig.weights is None else rig.weights[vertex]
    is_listed = (most > SOME) | (False if own is None else own > SOME)
    if joint is not None:
        is_listed[joint_index(rig.skeleton, joint)] = True
    listed = np.flatnonzero(is_listed)
    joints = listed[np.argsort(-last[listed], kind="stable")].tolist()
    shares = tuple(_share(rig, trace, joint) for joint in joints)
    progress("weights", 1.0)
    reason = int(distances.fallback[vertex])
    why = "" if reason == REACHED else FALLBACK_REASONS[reason]
    return Explanation(vertex, _place(rig.mesh.vertices[vertex]), why, shares)


def _traced(
    rig: Rig,
    vertex: int,
    method: Method,
    edits: Edits,
    distances: BoneDistances,
    progress: Progress,
) -> Trace:
    """Compute all weights, and keep those of a vertex after each step and each layer."""
    graph, reach = distances.graph, edits.reach
    adjustments = adjustments_of(rig, graph, reach)
    falloff = RigFalloff.over(distances, adjustments) if method.falloff == "rig" else None
    trace = Trace(vertex, method, distances, rig.allowed, adjustments, falloff)
    rows = trace.rows
    for step in weight_steps(distances, method, rig.allowed, adjustments, falloff, progress):
        number = graph.vertex_node[vertex] if step.welded else vertex
        row = step.weights[[number]].toarray()[0]
        if step.name == "normalise":
            rows["limit"] = np.where(row > 0, trace.last, 0.0)
        rows[step.name] = row

    def keep_layer(layer: Layer, weights: NDArray[np.float64]) -> None:
        if np.array_equal(weights[vertex], trace.last):
            return
        same = sum(name.split(" (")[0] == layer.title for name in rows)
        rows[layer.title if not same else f"{layer.title} ({same + 1})"] = weights[vertex].copy()

    base = Binding(step.weights, graph, distances, {}, (), method)

    def computed(layer: Layer) -> NDArray[np.float64]:
        return bind_layer(rig, base, reach, layer, progress).weights

    with_layers(rig, base, edits.stack(), computed, keep_layer)
    return trace


def _share(rig: Rig, trace: Trace, joint: int) -> JointShare:
    distances, vertex = trace.distances, trace.vertex
    graph, bones = distances.graph, distances.bones
    unit = graph.lattice.size
    distance = float(distances.at(joint, vertex))
    own = np.flatnonzero(bones.joint == joint)
    point = graph.nodes[graph.vertex_node[vertex]]
    straight = distance_to_segment(point, bones.start[own], bones.end[own]).min(initial=np.inf)
    factors = trace.factors(joint) if np.isfinite(distance) and len(own) else {}
    weight = {name: float(row[joint]) for name, row in trace.rows.items()}
    path = _path(distances, joint, vertex) if len(own) else ()
    length = sum(piece.length for piece in path) / unit
    final = float(trace.last[joint])
    absence = "" if final > 0 else trace.absence(joint, bool(path), factors)
    return JointShare(
        joint=joint,
        name=rig.skeleton.names[joint],
        path=path,
        distance=distance * unit,
        straight=float(straight) * unit,
        factors=factors,
        effective=distance * unit * float(np.prod(list(factors.values()))),
        steps=weight,
        weight=final,
        file_weight=None if rig.weights is None else float(rig.weights[vertex, joint]),
        rank=trace.rank(joint, length),
        absence=absence,
    )


def _path(distances: BoneDistances, joint: int, vertex: int) -> tuple[Piece, ...]:
    path = trace_path(distances, joint, vertex)
    lattice = distances.graph.lattice
    places = [_place(point) for point in lattice.to_file(path.points)]
    lengths = (path.lengths * lattice.size).tolist()
    parts = zip(path.kinds, places[:-1], places[1:], lengths, strict=True)
    return tuple(Piece(PIECES[kind], start, end, length) for kind, start, end, length in parts)


def _place(point: NDArray[np.float64]) -> tuple[float, float, float]:
    x, y, z = point.tolist()
    return x, y, z


def _finite(data: Any) -> Any:
    """Replace infinite numbers, which JSON has none of, by None."""
    if isinstance(data, dict):
        return {key: _finite(value) for key, value in data.items()}
    if isinstance(data, list | tuple):
        return [_finite(value) for value in data]
    return None if isinstance(data, float) and not np.isfinite(data) else data
