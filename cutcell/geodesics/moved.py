"""Distances while joints are on the move: only of the bones that changed."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ..method import Method
from ..rig import Skeleton
from .any_angle import ON_BONE
from .bone_extents import fit_bones
from .bones import Bones, bone_segments, find_sources
from .distances import BoneDistances, bone_distances, joint_paths, nodes_on_mesh, sorted_nodes
from .fallback import REACHED


def moved_distances(
    known: BoneDistances, skeleton: Skeleton, method: Method, within: float
) -> BoneDistances:
    """Measure distances again from joints whose bones are elsewhere; the others keep theirs.

    With connectivity 6 and 26 they are those of `bone_distances`, but for leaf bones, which are
    carried along as they are and not aimed again, and for vertices that no path reaches, which keep
    what they had. With any angle, a vertex that a joint left keeps
    to the others that it had, where there may be one that is nearer now.

    Parameters
    ----------
    known : BoneDistances
        Of the same graph, method, and joints that may carry weight; not of vertices that may
        follow different joints at one place.
    skeleton : Skeleton
    method : Method
    within : float
        As of `bone_distances`.

    Returns
    -------
    BoneDistances
    """
    graph = known.graph
    bones = _carried(known, skeleton, method)
    if bones is None:  # some continue others now that did not
        return bone_distances(
            graph, skeleton, method=method, nearest_joints=known.nearest_joints, within=within
        )
    old = known.bones
    changed = ((bones.start != old.start) | (bones.end != old.end)).any(axis=1)
    joints = np.unique(bones.joint[changed])
    if not len(joints):
        return known
    some = np.isin(bones.joint, joints)
    grid = sorted_nodes(graph)
    found = find_sources(graph, bones.some(some), method.samples, grid, known.contraction)
    targets = nodes_on_mesh(graph)
    fresh = joint_paths(graph, known.contraction, found, bones.some(some), targets)
    node = graph.vertex_node
    reached = np.zeros(len(targets), np.bool_)
    reached[node] = known.fallback == REACHED
    at_welded = known.at_welded.copy()
    at_welded[np.ix_(joints, reached)] = fresh[:, reached]
    if known.nearest_joints is not None:
        least = np.maximum(at_welded.min(axis=0), ON_BONE / graph.lattice.resolution)
        rows = at_welded[joints]
        rows[(rows > within * least) & reached] = np.inf
        at_welded[joints] = rows
    sources = known.sources.replaced(some, found)
    return replace(known, at_welded=at_welded, bones=bones, sources=sources)


def _carried(known: BoneDistances, skeleton: Skeleton, method: Method) -> Bones | None:
    """Return the bones with leaf bones as long as they were; None if there are others than were."""
    graph, old = known.graph, known.bones
    if method.leaf == "fit":
        bones, aimed = fit_bones(graph, skeleton, sorted_nodes(graph))
    else:
        bones = bone_segments(skeleton, method.leaf)
        ends = graph.lattice.to_unit(bones.start), graph.lattice.to_unit(bones.end)
        bones, aimed = Bones(*ends, bones.joint), np.zeros(len(bones.joint), np.bool_)
    if not np.array_equal(bones.joint, old.joint):
        return None
    carried = old.end + bones.start - old.start
    return Bones(bones.start, np.where(aimed[:, None], carried, bones.end), bones.joint)
