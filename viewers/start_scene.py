"""Where distances begin (paper section 3.2, figure "distance initialisation")."""

import numpy as np

from cutcell.geodesics import BoneDistances, bone_samples
from cutcell.rig import Rig

from .character import to_scene
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
    size = float(np.linalg.norm(np.ptp(to_scene(rig, rig.mesh.vertices), axis=0)))

    def placed(points: np.ndarray) -> np.ndarray:
        return to_scene(rig, graph.lattice.to_file(points))

    points, bone = bone_samples(graph, bones)
    samples = points[bones.joint[bone] == joint]
    of_joint = bones.joint[sources.bone] == joint
    nodes, of = graph.nodes[sources.node[of_joint]], sources.bone[of_joint]
    start, along = bones.start[of], bones.end[of] - bones.start[of]
    squared = (along**2).sum(axis=1)
    travel = ((nodes - start) * along).sum(axis=1)
    part = np.clip(travel / np.where(squared > 0, squared, 1), 0, 1)
    foot = start + part[:, None] * along
    ways = rods(placed(nodes), placed(foot), ROD * size)[:2]
    return {
        "samples": _solid(*beads(placed(samples), 0.7 * BEAD * size), theme.ink),
        "sources": _solid(*beads(placed(nodes), BEAD * size), SOURCE),
        "first distances": _solid(*ways, SOURCE),
    }


def first_distances(distances: BoneDistances, joint: int) -> np.ndarray:
    """Return the straight distances from a joint's sources to its bones, shape (s,)."""
    return distances.sources.distance[distances.bones.joint[distances.sources.bone] == joint]


def _solid(points: np.ndarray, faces: np.ndarray, color: tuple[float, float, float]) -> Actor:
    return Actor(
        "surface", points.astype(np.float32), faces.astype(np.int32), color=color, overlay=True,
        clipped=False,
    )  # fmt: skip
