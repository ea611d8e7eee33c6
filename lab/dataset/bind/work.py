"""Binding of one asset: from its bytes to the bytes of its file in the store."""

from __future__ import annotations

import tempfile
from collections.abc import Callable
from pathlib import Path
from time import perf_counter
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cutcell import __version__
from cutcell.binding import Binding, bind
from cutcell.checks import one_line
from cutcell.errors import CutcellError
from cutcell.geodesics import bone_distances
from cutcell.graph import INTERIOR, MESH, SURFACE
from cutcell.graph.memory import needed_memory
from cutcell.graph.rays import expected_hits
from cutcell.rig import Rig, Skeleton

from ...metrics import deformation_error, precision_recall, weight_l1
from ..read.entry import Entry, entry_bytes
from ..read.sources import Content, read_content
from ..read.store import Outcome, Parameters

COPIES = 8
"""Maximum number of tables of vertices by joints, or vertices by bones, at a time."""
BYTES_PER_FACE = 2600
"""Peak bytes a face of the stages after the graph; docs/performance.md, growth with the faces."""


def bind_content(
    content: Content,
    key: str,
    parameters: Parameters,
    reserve: Callable[[int], None] = lambda size: None,
) -> Outcome:
    """Bind one asset."""
    seconds: dict[str, float] = {}
    record: dict[str, Any] = {"version": __version__, "error": "", "warnings": []}
    data = None
    try:
        begin = perf_counter()
        with tempfile.TemporaryDirectory() as folder:
            rig = read_content(content, Path(folder))
        rig.require_joints()
        seconds["load"] = perf_counter() - begin
        needed = memory_needed(rig, parameters)
        record |= {"memory": needed, "warnings": list(rig.warnings)}
        reserve(needed)
        entry, results = _computed(rig, parameters, seconds)
        record |= results
        record["warnings"] = [*rig.warnings, *results["warnings"]]
        data = entry_bytes(entry, parameters.precision)
        record["bytes"] = len(data)
    except CutcellError as error:
        record["error"] = str(error)
    except MemoryError as error:
        record["error"] = f"there is not enough memory ({one_line(error)[:200]})"
    record["seconds"] = {name: round(value, 4) for name, value in seconds.items()}
    return Outcome(key, record, data)


def memory_needed(rig: Rig, parameters: Parameters) -> int:
    """Estimate an upper bound of the bytes that binding a rig takes."""
    resolution = parameters.method.resolution
    low, high = rig.mesh.bounds
    longest = float((high - low).max())
    vertices = (rig.mesh.vertices - low) / longest
    sides = (high - low) / longest
    points = resolution**3 * float(sides.prod())
    hits = expected_hits(vertices, rig.mesh.faces, resolution)
    graph = needed_memory(len(vertices), points, hits, parameters.method.connectivity)
    joints = len(rig.skeleton.joints)
    tables = len(vertices) * joints * 8 * COPIES * (3 if parameters.bones else 1)
    return int(graph + tables + BYTES_PER_FACE * len(rig.mesh.faces))


def _computed(
    rig: Rig, parameters: Parameters, seconds: dict[str, float]
) -> tuple[Entry, dict[str, Any]]:
    binding = bind(rig, method=parameters.method)
    seconds |= binding.seconds
    begin = perf_counter()
    bones = rignet_bones(rig.skeleton) if parameters.bones else np.zeros((0, 2), np.int32)
    by_bone = _by_bone(rig, binding, bones, parameters)
    seconds["bones"] = perf_counter() - begin
    begin = perf_counter()
    metrics = _metrics(rig, binding)
    seconds["metrics"] = perf_counter() - begin
    graph = binding.graph
    skeleton = rig.skeleton
    entry = Entry(
        rig.mesh.vertices.astype(np.float32),
        rig.mesh.faces,
        skeleton.joints.astype(np.float32),
        skeleton.parents,
        skeleton.names,
        graph.lattice.size,
        binding.weights.astype(np.float32),
        None if rig.weights is None else rig.weights.astype(np.float32),
        binding.distances.joint.T.astype(np.float32),
        bones,
        by_bone.astype(np.float32),
    )
    sizes = {
        "vertices": len(rig.mesh.vertices),
        "faces": len(rig.mesh.faces),
        "joints": len(skeleton.joints),
        "bones": len(bones),
        "nodes": len(graph.nodes),
        "edges": len(graph.edges),
    }
    names = {"mesh": MESH, "interior": INTERIOR, "surface": SURFACE}
    kinds = {name: int((graph.node_kind == code).sum()) for name, code in names.items()}
    return entry, {
        "sizes": sizes,
        "graph": kinds,
        "closed": bool(graph.is_closed),
        "metrics": metrics,
        "warnings": list(binding.warnings),
    }


def _metrics(rig: Rig, binding: Binding) -> dict[str, float | None]:
    """Measure weights: against the artist's where there are any."""
    metrics: dict[str, float | None] = {
        "fallback": float((binding.distances.fallback > 0).mean()),
        "influences": float((binding.weights > 0).sum(axis=1).mean()),
        "stretch": binding.stretch.share,
    }
    if rig.weights is None or not rig.weights.any():
        return metrics
    precision, recall = precision_recall(binding.weights, rig.weights)
    metrics |= {"l1": weight_l1(binding.weights, rig.weights), "precision": precision}
    worst = deformation_error(rig, binding.weights, rig.weights)
    metrics |= {"recall": recall, "deformation": worst.mean}
    return {
        name: None if value is None or np.isnan(value) else value for name, value in metrics.items()
    }


def rignet_bones(skeleton: Skeleton) -> NDArray[np.int32]:
    """List the bones as RigNet does, as pairs of joints, shape (b, 2).

    Level by level from the root, for each joint the bones to its children in their order; after
    the bone to a joint without children that joint itself, a point. Roots after the first follow.
    """
    children = skeleton.children
    bones: list[tuple[int, int]] = []
    for root in np.flatnonzero(skeleton.parents < 0).tolist():
        if len(children[root]) == 0:
            bones.append((root, root))
        queue = [root]
        for joint in queue:  # grows: a breadth-first search
            for child in children[joint].tolist():
                queue.append(child)
                bones.append((joint, child))
                if len(children[child]) == 0:
                    bones.append((child, child))
    return np.array(bones, np.int32).reshape(-1, 2)


def _by_bone(
    rig: Rig, binding: Binding, bones: NDArray[np.int32], parameters: Parameters
) -> NDArray[np.float64]:
    """Compute the distance of every single bone to every vertex, shape (n, b).

    Each bone becomes a separate joint, so that `bone_distances` does not take the minimum over
    the bones of a joint.
    """
    if not len(bones):
        return np.zeros((len(rig.mesh.vertices), 0))
    count = len(bones)
    ends = bones[:, 1] != bones[:, 0]
    parents = np.full(count + int(ends.sum()), -1)
    parents[count:] = np.flatnonzero(ends)
    joints = np.concatenate([rig.skeleton.joints[bones[:, 0]], rig.skeleton.joints[bones[ends, 1]]])
    single = Skeleton(joints, parents, deform=np.arange(len(joints)) < count)
    distances = bone_distances(
        binding.graph,
        single,
        method=parameters.method,
        leaf="point",
        nearest=count,
        nearest_joints=count,
        within=np.inf,
    )
    return distances.joint[:count].T
