"""Bones fitted to the body: where they end, which files seldom tell.

A joint is where a bone begins. Where it ends is known only if one child goes on from there. For
all others: the last bone of a limb runs on until it leaves the body; then, once it is known
which skin is nearest to it, it is aimed at the middle of that.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.distance import cdist

from ..graph import CutCellGraph
from ..rig import Skeleton
from .bones import Bones
from .chains import SAME_PLACE, find_chains
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
    tip : array, shape (b,), bool
        Bones whose end no other joint tells; see `aim_tips`.
    """
    probe = BodyProbe(graph, grid)
    chains = find_chains(skeleton, graph.lattice.to_unit(skeleton.joints), probe)
    end, joint = [], []
    for j in np.flatnonzero(skeleton.deform).tolist():
        told = [*chains.ends[j], *chains.links[j]]
        end += told or [chains.joints[j]]
        joint += [j] * max(len(told), 1)
    bones = Bones(chains.joints[joint], np.array(end), np.array(joint, np.int32))
    tip = np.array([not (chains.ends[j] or chains.links[j]) for j in joint])
    # A tip goes on the way its bone came until it leaves the body.
    tips = bones.joint[tip]
    way = probe.way_out(chains.joints[tips], chains.direction[tips])
    bones.end[tip] += chains.direction[tips] * way[:, None]
    return _share_with_tips(bones, tip, probe), tip & chains.near[bones.joint]


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
    count = len(nearest)
    points, share = graph.nodes[:count], _areas(graph, count)
    for b, own in zip(np.flatnonzero(tip), distance, strict=True):
        mine = np.flatnonzero(np.isfinite(own))
        ratio = np.divide(nearest[mine], own[mine], out=np.ones(len(mine)), where=own[mine] > 0)
        weight = share[mine] * ratio**REGION_POWER
        if weight.sum() > 0:
            end[b] = weight @ points[mine] / weight.sum()
    return Bones(bones.start, end, bones.joint)


def _areas(graph: CutCellGraph, count: int) -> NDArray[np.float64]:
    """Return the area of the triangles around each place of the mesh."""
    corners = graph.nodes[graph.faces]
    across = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    area = np.linalg.norm(across, axis=1)
    areas = np.bincount(graph.faces.ravel(), np.repeat(area, 3), count)
    return np.asarray(areas, np.float64)
