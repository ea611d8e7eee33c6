"""Sources of distances (paper section 3.2, figure "distance initialisation")."""

from functools import partial

import numpy as np

from cutcell.geodesics import BoneDistances, bone_samples
from cutcell.geometry.segments import closest_on_segment
from cutcell.rig import Rig

from .character import diagonal, lattice_to_scene
from .description import Actor
from .marks import beads, rods
from .palette import SOURCE, Theme

BEAD, ROD = 0.004, 0.0016
"""Radius and thickness, in parts of the diagonal of the body's box."""


def start_scene(rig: Rig, distances: BoneDistances, joint: int, theme: Theme) -> dict[str, Actor]:
    """Return a joint's samples, its sources, and the straight ways between source and bone.

    Parameters
    ----------
    rig : Rig
    distances : BoneDistances
    joint : int
    theme : Theme

    Returns
    -------
    dict of str to Actor
        "samples" on the bone, "sources" among the graph's nodes, "first distances".
    """
    graph, bones, sources = distances.graph, distances.bones, distances.sources
    size, placed = diagonal(rig), partial(lattice_to_scene, rig, graph.lattice)
    points, bone = bone_samples(graph, bones)
    samples = points[bones.joint[bone] == joint]
    of_joint = bones.joint[sources.bone] == joint
    nodes, of = graph.nodes[sources.node[of_joint]], sources.bone[of_joint]
    foot, _ = closest_on_segment(nodes, bones.start[of], bones.end[of])
    ways = rods(placed(nodes), placed(foot), ROD * size)[:2]
    return {
        name: Actor.solid(*shape, color=color, overlay=True)
        for name, shape, color in (
            ("samples", beads(placed(samples), 0.7 * BEAD * size), theme.ink),
            ("sources", beads(placed(nodes), BEAD * size), SOURCE),
            ("first distances", ways, SOURCE),
        )
    }


def first_distances(distances: BoneDistances, joint: int) -> np.ndarray:
    """Return the straight distances from a joint's sources to its bones, shape (s,)."""
    return distances.sources.distance[distances.bones.joint[distances.sources.bone] == joint]
