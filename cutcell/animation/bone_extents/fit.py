"""Bone extents fitted to the body: where bones end, which files seldom say.

A joint is where a bone begins. Where the bone ends is known only if one child continues it. All
others are leaf bones: each runs on until it leaves the body, or comes nearer to another bone. Where
no rest axis is known, its direction is a guess, so it is aimed at the middle of the skin that is
nearest to it.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array
from scipy.spatial.distance import cdist

from ...bones.bones import Bones
from ...bones.nearest import NodeGrid
from ...geometry.triangles import areas
from ...geometry.vectors import TIE
from ...graph import CutCellGraph
from ...rig import Skeleton
from ...rig.rows import rows_of_entries
from .chains import COINCIDENT_ENDS, MAX_LENGTH_RATIO, Chains, find_chains
from .probe import BodyProbe
from .skins import characters, share_a_skin

REGION_LEAVES = 3
"""Leaf bones that skin is assigned to, its nearest. In the middle between left and right there are
two."""
REGION_WITHIN = 1.25
"""Skin to which another joint is nearer by this factor belongs to that joint alone: the leaf bone's
share of it would be a hundredth."""
REGION_POWER = 20
"""Skin is shared among joints by this power of the nearest distance over their own."""
MIN_BONE_CELLS = 2.0
"""Lattice cells of the character alone: such a bone is at least this long, if the body is still
near there. Shorter ones have hardly any direction."""


def fit_bones(
    graph: CutCellGraph,
    skeleton: Skeleton,
    grid: NodeGrid,
    allowed: NDArray[np.bool_] | None = None,
) -> tuple[Bones, NDArray[np.bool_]]:
    """Find the bones of every joint that may carry weight, of each character by itself.

    Shapes: allowed (n, j), see `Rig.allowed`; returns aimed (b,).
    """
    probe = BodyProbe(graph, grid)
    together = share_a_skin(allowed, len(skeleton.joints))
    parts = []
    for joints, own in characters(skeleton, together):
        size = 1.0
        if len(joints) < len(together):
            assert allowed is not None
            points = graph.nodes[graph.vertex_node[allowed[:, joints].any(axis=1)]]
            size = float(np.ptp(points, axis=0).max()) if len(points) else size
        of_skin = together[np.ix_(joints, joints)]
        parts.append(_fit_character(joints, own, of_skin, graph, probe, size))
    joint = np.concatenate([bones.joint for bones, _ in parts])
    order = np.argsort(joint, kind="stable")
    bones = Bones(
        np.concatenate([bones.start for bones, _ in parts])[order],
        np.concatenate([bones.end for bones, _ in parts])[order],
        joint[order],
        tuple(pair for bones, _ in parts for pair in bones.inferred),
    )
    return bones, np.concatenate([aimed for _, aimed in parts])[order]


def _fit_character(
    number: NDArray[np.intp],
    skeleton: Skeleton,
    together: NDArray[np.bool_],
    graph: CutCellGraph,
    probe: BodyProbe,
    size: float,
) -> tuple[Bones, NDArray[np.bool_]]:
    """Find the bones of a skeleton whose joints have these numbers, shape (j,), in the file.

    `size` is the longest side of its mesh.
    """
    chains = find_chains(skeleton, graph.lattice.to_unit(skeleton.joints), together, probe)
    start, end = [], []
    for j in np.flatnonzero(skeleton.deform).tolist():
        ends = chains.ends[j] + chains.inferred[j] or [j]
        end += ends
        start += [j] * len(ends)
    joint = np.array(start, np.int32)
    leaf = joint == end
    bones = Bones(chains.joints[joint], chains.joints[end], joint)
    leaves = bones.joint[leaf]
    onward = chains.onward[leaves]
    reach = probe.exit_distance(chains.joints[leaves], onward)
    bones.end[leaf] += onward * reach[:, None]
    length = _leaf_lengths(bones, leaf, chains, reach, probe, size)
    length[chains.in_eye[leaves]] = 0
    bones.end[leaf] = chains.joints[leaves] + onward * length[:, None]
    aimed = leaf.copy()
    aimed[leaf] = (chains.rest is None) & chains.near[leaves] & ~chains.in_eye[leaves]
    inferred = tuple(
        (int(number[j]), int(number[k])) for j, goals in enumerate(chains.inferred) for k in goals
    )
    return Bones(bones.start, bones.end, number[joint].astype(np.int32), inferred), aimed


def _leaf_lengths(
    bones: Bones,
    leaf: NDArray[np.bool_],
    chains: Chains,
    reach: NDArray[np.float64],
    probe: BodyProbe,
    size: float,
) -> NDArray[np.float64]:
    """Measure the lengths (t,) of the leaf bones of a character with this longest side.

    Each ends where it leaves the body (`reach`), or where it comes nearer, through the body, to
    the bone of another joint than to its own joint: a jaw does not continue through the skull.
    """
    joint = bones.joint[leaf]
    place, onward = chains.joints[joint], chains.onward[joint]
    length = probe.distance_to_others(place, onward, reach, _others(bones, leaf, chains))
    if chains.rest is None:
        return length
    before = chains.length[joint]
    length = np.minimum(length, np.where(before > 0, MAX_LENGTH_RATIO * before, np.inf))
    least = MIN_BONE_CELLS * size / probe.resolution
    is_long = probe.near(place + onward * least) | (length > least)
    return np.where(is_long, np.maximum(length, least), length)


def _others(
    bones: Bones, leaf: NDArray[np.bool_], chains: Chains
) -> Iterator[tuple[NDArray[np.float64], NDArray[np.float64]]]:
    """Yield for each leaf bone those of others that do not end at it; of leaf bones the start.

    The face does not end the bone of a head.
    """
    end = np.where(leaf[:, None], bones.start, bones.end)
    to_face = cdist(bones.end, chains.joints[chains.in_face]) < COINCIDENT_ENDS
    of_face = chains.in_face[bones.joint] | to_face.any(axis=1)
    for joint in bones.joint[leaf]:
        ends_at_it = np.abs(bones.end - chains.joints[joint]).max(axis=1) < COINCIDENT_ENDS
        other = (bones.joint != joint) & ~ends_at_it
        if not chains.in_face[joint]:
            other &= ~of_face
        yield bones.start[other], end[other]


def aim_leaf_bones(
    graph: CutCellGraph,
    bones: Bones,
    aimed: NDArray[np.bool_],
    distance: csr_array,
    nearest: NDArray[np.float64],
) -> Bones:
    """End leaf bones in the middle of the skin that they move.

    Shapes: aimed (b,), distance (k, t), nearest (k,).
    """
    points = graph.nodes[: len(nearest)]
    area = np.bincount(graph.faces.ravel(), np.repeat(areas(points[graph.faces]), 3), len(points))
    leaf, vertex, leaves = distance.indices, rows_of_entries(distance), distance.shape[1]
    share = np.maximum(nearest[vertex], TIE) / np.maximum(distance.data, TIE)
    part = area[vertex] * share**REGION_POWER
    total = np.bincount(leaf, part, leaves)
    moments = [np.bincount(leaf, part * points[vertex, axis], leaves) for axis in range(3)]
    has_skin = total > 0
    end = bones.end.copy()
    middle = np.array(moments).T[has_skin] / total[has_skin, None]
    end[np.flatnonzero(aimed)[has_skin]] = middle
    return replace(bones, end=end)
