"""Bones as segments, and where in the graph their distances begin (paper section 3.2)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..checks import check_choice
from ..geometry.vectors import TIE
from ..graph import CutCellGraph
from ..method import LEAVES
from ..rig import Skeleton

MAX_SAMPLED_LENGTH = 20.0
"""Longest sides of the mesh that a bone has samples of: it may lead to a joint however far."""


@dataclass(frozen=True, eq=False)
class Bones:
    """Bones of the joints, as segments.

    Parameters
    ----------
    start, end : arrays, shape (b, 3)
        Ends of each bone; equal if the bone is a point.
    joint : array, shape (b,), int32
        The joint at the parent end of the bone, which moves it. Ascending.
    inferred : tuple of pairs of int
        The joints at the ends of bones that the joint tree of the file does not have.
    """

    start: NDArray[np.float64]
    end: NDArray[np.float64]
    joint: NDArray[np.int32]
    inferred: tuple[tuple[int, int], ...] = ()

    def subset(self, which: NDArray[np.bool_]) -> Bones:
        """Return those bones for which `which`, shape (b,), is true."""
        return Bones(self.start[which], self.end[which], self.joint[which])


def bone_segments(skeleton: Skeleton, leaf: str = "point") -> Bones:
    """List the bones of every joint that may carry weight.

    A joint's bones run to its child joints.

    Parameters
    ----------
    skeleton : Skeleton
    leaf : {"point", "extend"}
        The bone of a joint without children is a point, or extends its parent's bone by half
        of that bone's length. The bone of a single joint is a point either way.

    Returns
    -------
    Bones
        Ordered by joint; in the units of the skeleton.

    Raises
    ------
    ParameterError
        An unknown `leaf`.
    SkeletonError
        No joints.
    """
    check_choice("leaf", leaf, LEAVES[:2])
    skeleton.require_joints()
    start, end, joint = [], [], []
    for j in np.flatnonzero(skeleton.deform):
        head = skeleton.joints[j]
        tails = [skeleton.joints[k] for k in skeleton.children[j]]
        if not tails:
            parent = skeleton.parents[j]
            extend = leaf == "extend" and parent >= 0
            tails = [head + (head - skeleton.joints[parent]) / 2 if extend else head]
        for tail in tails:
            start.append(head)
            end.append(tail)
            joint.append(j)
    return Bones(np.array(start), np.array(end), np.array(joint, np.int32))


@dataclass(frozen=True, eq=False)
class Sources:
    """Nodes where the distances of bones begin.

    Parameters
    ----------
    node : array, shape (s,), int32
    bone : array, shape (s,), int32
        Ascending.
    distance : array, shape (s,), float64
        From the node straight to the bone.
    """

    node: NDArray[np.int32]
    bone: NDArray[np.int32]
    distance: NDArray[np.float64]

    def subset(self, which: NDArray[np.bool_]) -> Sources:
        """Return those of the bones for which `which`, shape (b,), is true, renumbered."""
        chosen = which[self.bone]
        number = np.cumsum(which, dtype=np.int32) - 1
        return Sources(self.node[chosen], number[self.bone[chosen]], self.distance[chosen])

    def replaced(self, which: NDArray[np.bool_], other: Sources) -> Sources:
        """Return these sources with those of some bones replaced; `other` numbers only these."""
        remains = ~which[self.bone]
        bone = np.concatenate([self.bone[remains], np.flatnonzero(which)[other.bone]])
        order = np.argsort(bone, kind="stable")
        node, distance = (
            np.concatenate([old[remains], new])[order]
            for old, new in ((self.node, other.node), (self.distance, other.distance))
        )
        return Sources(node, bone[order].astype(np.int32), distance)


def bone_samples(
    graph: CutCellGraph, bones: Bones, samples: int = 5
) -> tuple[NDArray[np.float64], NDArray[np.intp]]:
    """Place evenly spaced points on each bone.

    Parameters
    ----------
    graph : CutCellGraph
    bones : Bones
        In the unit cube.
    samples : int
        N, points on each bone, both ends included; a single one is in the middle. With
        connectivity "any" at least one for each lattice cell, up to a length of
        `MAX_SAMPLED_LENGTH`.

    Returns
    -------
    points : array, shape (p, 3), float64
        In the unit cube, bone by bone.
    bone : array, shape (p,)
        The bone of each point.
    """
    counts, way = np.full(len(bones.joint), samples), bones.end - bones.start
    if graph.connectivity == "any":
        # Every lattice point along the bone must have line of sight to it.
        length = np.linalg.norm(way, axis=1)
        way = way * (MAX_SAMPLED_LENGTH / np.maximum(length, MAX_SAMPLED_LENGTH))[:, None]
        cells = (np.minimum(length, MAX_SAMPLED_LENGTH) - TIE) * graph.lattice.resolution
        counts = np.maximum(counts, np.ceil(cells).astype(int) + 1)
    bone = np.repeat(np.arange(len(counts)), counts)
    number = np.arange(len(bone)) - (np.cumsum(counts) - counts)[bone]
    share = np.where(counts > 1, 0.0, 0.5)[bone] + number / np.maximum(counts - 1, 1)[bone]
    return bones.start[bone] + share[:, None] * way[bone], bone


def least_of_joints(distance: NDArray[np.float64], bones: Bones) -> NDArray[np.float64]:
    """Reduce distances of bones (b, t) to those of the joints that have bones."""
    first = np.flatnonzero(np.diff(bones.joint, prepend=-1))
    return np.minimum.reduceat(distance, first, axis=0)
