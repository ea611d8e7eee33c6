"""Distances where vertices may follow different joints, as those of several skins."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.sparse import csr_array, vstack

from ..bones.bones import Bones, Sources
from ..errors import WeightsError
from ..graph import CutCellGraph
from ..rig.checks import as_array
from ..rig.rows import chosen_entries, rows_of_entries, with_columns
from ..runtime.progress import Progress
from .solver import BoneDistanceSolver


def check_allowed(
    graph: CutCellGraph, deform: NDArray[np.bool_], allowed: ArrayLike
) -> NDArray[np.bool_]:
    """Return which joints vertices may follow; each needs one that carries weight (`deform`)."""
    shape = (len(graph.vertex_node), len(deform))
    allowed = as_array(allowed, np.bool_, shape, "allowed", WeightsError)
    bad = np.flatnonzero(~allowed[:, deform].any(axis=1))
    if len(bad):
        raise WeightsError(
            f"vertex {bad[0]} may follow no joint that carries weight "
            f"({len(bad)} vertices are so); check which joints its skin lists"
        )
    return allowed


def allowed_distances(
    solver: BoneDistanceSolver,
    bones: Bones,
    sources: Sources,
    nearest_joints: int | None,
    within: float,
    allowed: NDArray[np.bool_],
    progress: Progress,
) -> tuple[csr_array, int | None]:
    """Compute the distances (n, j) of the joints that each vertex may follow.

    The nearest joints are measured once for each set of joints that vertices may follow, or all
    joints where that is sooner. Also returns how many were measured, None for all.

    Shapes: allowed (n, j).
    """
    node, joints = solver.graph.vertex_node, np.unique(bones.joint)
    keys = _row_keys(allowed[:, joints])
    _, first, group = np.unique(keys, return_index=True, return_inverse=True)
    # As many other joints are measured at each vertex.
    if nearest_joints is None or len(first) * 2 * nearest_joints > len(joints):
        by_node = solver.paths(bones, sources, progress=progress)
        rows = with_columns(by_node[node], joints, allowed.shape[1])
        return chosen_entries(rows, allowed[rows_of_entries(rows), rows.indices]), None
    parts = []
    for k, example in enumerate(first):
        progress("distances", k / len(first))
        chosen = allowed[example, bones.joint]
        targets, number = np.unique(node[group == k], return_inverse=True)
        by_node = solver.paths(
            bones.subset(chosen), sources.subset(chosen), nearest_joints, within, targets=targets
        )
        number_of_joint = np.unique(bones.joint[chosen])
        parts.append(with_columns(by_node[number], number_of_joint, allowed.shape[1]))
    place = np.argsort(np.argsort(group, kind="stable"))  # of each vertex, group by group
    return csr_array(vstack(parts, format="csr")[place]), nearest_joints


def _row_keys(rows: NDArray[np.bool_]) -> NDArray[np.void]:
    """Return a value for each row (n, j) that is equal where rows are equal, (n,)."""
    packed = np.ascontiguousarray(np.packbits(rows, axis=1))
    return packed.view(np.dtype((np.void, packed.shape[1])))[:, 0]
