"""Template of a quadruped."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from .frame import TRUNK, Joints, mirrored, sided
from .interior import Interior, along, cut

TAIL = ("tail.1", "tail.2", "tail.3")
QUADRUPED_PARENTS = {
    **dict(zip(TRUNK, ("", *TRUNK), strict=False)),
    **dict(zip(TAIL, ("hips", *TAIL), strict=False)),
    **sided(
        front_thigh="chest", front_shin="front_thigh", front_foot="front_shin",
        thigh="hips", shin="thigh", foot="shin",
    ),
}  # fmt: skip

QUADRUPED_SOLE = 0.08
"""Height below which points belong to the feet, in body heights."""
LEG = np.array([0.08, 0.5, 1.05])
"""Shares of the path from the ground to the trunk: foot, knee, top of the leg."""


def place(body: Interior) -> Joints:
    """Return where the joints of `QUADRUPED_PARENTS` are in a body."""
    points = body.points
    y, z = points[:, 1] - body.floor, points[:, 2]
    low = y < QUADRUPED_SOLE * body.height
    half = (z[low].min() + z[low].max()) / 2
    feet = {}
    for end, before in (("front_", True), ("", False)):
        for side, sign in (("L", 1), ("R", -1)):
            is_foot = low & (before == (z > half)) & (sign * points[:, 0] > 0)
            feet[end, side] = body.central(is_foot if is_foot.any() else low)
    middle = np.abs(points[:, 0]) < 0.25 * np.abs(points[:, 0]).max() + body.cell
    trunk = y > 0.3 * body.height
    belly = body.deepest(middle & trunk & (np.abs(z - half) < 0.2 * np.ptp(z)))
    away = body.distances(belly)
    head = _end(z, middle & trunk)  # the nose: ears and antlers reach farther, but not to the front
    joints: Joints = {}
    tops = {}
    for end, other in (("front_", ""), ("", "front_")):
        for side, opposite in ("LR", "RL"):
            foot = feet[end, side]
            far = body.branch(foot, feet[end, opposite], feet[other, side])
            far = max(far, 0.25 * away[foot])
            path = cut(body, foot, belly, min(LEG[-1] * far, 0.9 * away[foot]))
            names = [f"{end}{name}.{side}" for name in ("foot", "shin", "thigh")]
            joints |= zip(names, along(path, LEG / LEG[-1]), strict=True)
        tops[end] = (joints[f"{end}thigh.L"] + joints[f"{end}thigh.R"]) / 2
    hips, chest = (_inner(body, middle, tops[end]) for end in ("", "front_"))
    spine = body.middle_path(hips, chest)
    joints["hips"], joints["chest"] = body.points[hips].copy(), body.points[chest].copy()
    joints["spine"] = along(spine, np.array([0.5]))[0]
    neck = body.middle_path(chest, head)
    joints["neck"], joints["head"] = along(neck, np.array([0.3, 0.7]))
    between = 0.5 * np.mean([abs(points[foot, 0]) for foot in feet.values()]) + body.cell / 2
    behind = (np.abs(points[:, 0]) < between) & (z < joints["hips"][2])
    behind &= (y > 0.25 * body.height) & (body.distances(hips) < body.distances(head))
    hind = [body.distances(feet["", side]) for side in "LR"]
    off_legs = body.distances(hips) + np.min([far - far[hips] for far in hind], axis=0)
    tail = _end(off_legs, behind)  # nodes on the path to a foot are no tail
    path = body.middle_path(hips, tail)
    joints |= zip(TAIL, along(path, np.array([0.35, 0.57, 0.78])), strict=True)
    return mirrored(joints, float(np.ptp(points, axis=0).max()))


def _end(far: NDArray[np.float64], among: NDArray[np.bool_]) -> int:
    """Return which of some nodes, or of all where there are none, is the farthest."""
    chosen = np.flatnonzero(among) if among.any() else np.arange(len(far))
    return int(chosen[far[chosen].argmax()])


def _inner(body: Interior, middle: NDArray[np.bool_], top: NDArray[np.float64]) -> int:
    """Return the deepest node between two legs, in the middle of the trunk."""
    near = middle & (np.abs(body.points[:, 2] - top[2]) < 2 * body.cell)
    near &= body.points[:, 1] > top[1] - 2 * body.cell
    return body.deepest(near) if near.any() else body.nearest(top * [0.0, 1.0, 1.0])
