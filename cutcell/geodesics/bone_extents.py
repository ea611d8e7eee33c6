"""Bones fitted to the body: where they end, which files seldom tell.

A joint is where a bone begins. Where it ends is known only if one child goes on from there. For
all others: the last bone of a limb runs on until it leaves the body; then, once it is known
which skin is nearest to it, it is aimed at the middle of that.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.distance import cdist

from ..compiled import lean
from ..graph import CutCellGraph
from ..rig import Skeleton
from .bones import Bones
from .chains import SAME_PLACE, find_chains
from .last_bones import last_bone_lengths, moves_what_is_near
from .nearest import NodeGrid
from .probe import BodyProbe

NO_ROOM = 2.0
"""Depths of the body: a tip with less room than this before it leaves the body is given some of
the bone that leads to it."""
GIVEN = 2.0
"""Depths of the body that it is given at most."""
REGION_TIPS = 3
"""Tips that skin is looked at for, the nearest to it. In the middle between left and right there
are two."""
REGION_WITHIN = 1.25
"""Skin from which another joint is so many times nearer belongs to that one altogether: the tip's
part of it would be a hundredth."""
REGION_POWER = 20
"""Skin belongs to joints by this power of how much nearer the nearest one is."""


def fit_bones(
    graph: CutCellGraph, skeleton: Skeleton, grid: NodeGrid
) -> tuple[Bones, NDArray[np.bool_]]:
    """Find the bones of every joint that may carry weight.

    Parameters
    ----------
    graph : CutCellGraph
    skeleton : Skeleton
        In the units of the graph's mesh.
    grid : NodeGrid
        Of the graph's nodes.

    Returns
    -------
    bones : Bones
        In the unit cube, ordered by joint.
    aimed : array, shape (b,), bool
        Bones whose end neither another joint nor the rest orientation tells; see `aim_tips`.
    """
    probe = BodyProbe(graph, grid)
    chains = find_chains(skeleton, graph.lattice.to_unit(skeleton.joints), probe)
    start, end = [], []
    for j in np.flatnonzero(skeleton.deform).tolist():
        told = chains.ends[j] + chains.links[j] or [j]
        end += told
        start += [j] * len(told)
    joint = np.array(start, np.int32)
    tip = joint == end
    bones = Bones(chains.joints[joint], chains.joints[end], joint)
    tips = bones.joint[tip]
    onward = chains.onward[tips]
    way = probe.way_out(chains.joints[tips], onward)
    bones.end[tip] += onward * way[:, None]
    bones = _share_with_tips(bones, tip, probe)
    way, pointed = last_bone_lengths(bones, tip, chains, way, probe)
    under_skin = (skeleton.parents[tips] >= 0) & moves_what_is_near(chains.joints[tips], probe)
    way[under_skin] = 0
    bones.end[tip] = chains.joints[tips] + onward * way[:, None]
    aimed = tip.copy()
    aimed[tip] = ~pointed & ~under_skin & chains.near[tips]
    return bones, aimed


def _share_with_tips(bones: Bones, tip: NDArray[np.bool_], probe: BodyProbe) -> Bones:
    """Shorten bones that end at a tip without room of its own, such as a foot on the ground.

    Its joint lies at the very end of the body; were the bone before it to reach there, nothing
    would be left for it to move.
    """
    end = bones.end.copy()
    room = np.linalg.norm(bones.end - bones.start, axis=1)
    goes_on = tip & (cdist(bones.end, bones.start) < SAME_PLACE)
    before = np.flatnonzero(~tip & goes_on.any(axis=1))
    depth = probe.depth((bones.start[before] + bones.end[before]) / 2)
    own, left = room[before], np.where(goes_on[before], room, 0.0).max(axis=1, initial=0.0)
    short = left < np.minimum(own, NO_ROOM * depth)
    cut = np.minimum((own - left) / 2, GIVEN * depth)
    share = np.divide(cut, own, out=np.zeros_like(own), where=short)
    end[before] += (bones.start - bones.end)[before] * share[:, None]
    return Bones(bones.start, end, bones.joint)


def aim_tips(
    graph: CutCellGraph,
    bones: Bones,
    tip: NDArray[np.bool_],
    distance: NDArray[np.float64],
    nearest: NDArray[np.float64],
) -> Bones:
    """End tips in the middle of the skin that they move.

    Parameters
    ----------
    graph : CutCellGraph
    bones : Bones
        In the unit cube.
    tip : array, shape (b,), bool
        Which to aim.
    distance : array, shape (t, k)
        From each tip to the places of the mesh: the first nodes of the graph. Infinite where
        it is not wanted.
    nearest : array, shape (k,)
        From the nearest of all joints.

    Returns
    -------
    Bones
    """
    end = bones.end.copy()
    points = graph.nodes[: len(nearest)]
    share = np.zeros(len(points))
    _add_areas(points, graph.faces, share)
    total, middle = np.zeros(len(distance)), np.zeros((len(distance), 3))
    _weigh(points, share, distance, nearest, total, middle)
    some = total > 0
    end[np.flatnonzero(tip)[some]] = middle[some] / total[some, None]
    return Bones(bones.start, end, bones.joint)


@lean
def _weigh(points, share, distance, nearest, total, middle):
    """Add up each tip's skin, and its skin times where it is."""
    for tip in range(len(distance)):
        for k in range(len(points)):
            own = distance[tip, k]
            if own < np.inf:
                part = share[k] * (nearest[k] / own if own > 0 else 1.0) ** REGION_POWER
                total[tip] += part
                for axis in range(3):
                    middle[tip, axis] += part * points[k, axis]


@lean
def _add_areas(points, faces, areas):
    """Add twice the area of each triangle to all its corners."""
    for f in range(len(faces)):
        a, b, c = faces[f, 0], faces[f, 1], faces[f, 2]
        squared = 0.0
        for axis in range(3):
            i, j = (axis + 1) % 3, (axis + 2) % 3
            normal = (points[b, i] - points[a, i]) * (points[c, j] - points[a, j])
            normal -= (points[b, j] - points[a, j]) * (points[c, i] - points[a, i])
            squared += normal * normal
        for corner in range(3):
            areas[faces[f, corner]] += np.sqrt(squared)
