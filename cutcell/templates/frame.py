"""The frame of a body: its left, up and front, and joints mirrored across it."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

SYMMETRIC_WITHIN = 0.06
"""Difference below which left and right joints become symmetric, in longest sides of the body."""
Joints = dict[str, NDArray[np.float64]]
"""Position of each joint by its name, in the body's frame."""
TRUNK = ("hips", "spine", "chest", "neck", "head")
MIRROR_SAMPLES = 4000
"""Vertices that are compared with their mirror images."""
CLEARLY_SHORTER = 0.8
"""One axis is longer, or more of a mirror, if another has at most this part of it."""


def sided(**parents: str) -> dict[str, str]:
    """Return the parents of joints on the left and of those on the right."""
    return {
        f"{name}.{side}": parent if parent in TRUNK else f"{parent}.{side}"
        for side in "LR"
        for name, parent in parents.items()
    }


def mirror_axis(nodes: NDArray[np.float64]) -> int:
    """Return the coordinate axis across which points (n, 3) are most like their mirror images."""
    chosen = nodes[:: max(1, len(nodes) // MIRROR_SAMPLES)]
    tree = cKDTree(chosen)
    gaps = []
    for axis in range(3):
        image = chosen.copy()
        image[:, axis] = nodes[:, axis].min() + nodes[:, axis].max() - image[:, axis]
        gaps.append(float(tree.query(image)[0].mean()))
    if gaps[0] < gaps[1] / CLEARLY_SHORTER and gaps[0] < gaps[2] / CLEARLY_SHORTER:
        return 0  # nearly all characters are mirrored across x
    return int(np.argmin(gaps))


def standing(nodes: NDArray[np.float64], *, tall: bool) -> NDArray[np.float64]:
    """Return the axes of a body that stands: left, up and front, rows of (3, 3).

    Shapes: nodes (n, 3).
    """
    extent = np.ptp(nodes, axis=0)
    side = mirror_axis(nodes)
    up, other = (axis for axis in (1, 2, 0) if axis != side)  # y is up in most files, then z
    if tall:
        is_other = extent[other] * CLEARLY_SHORTER > extent[up]
    else:
        is_other = _feet(nodes, other) > _feet(nodes, up) / CLEARLY_SHORTER
    up = other if is_other else up
    front = 3 - side - up
    axes = np.zeros((3, 3))
    axes[1, up] = 1
    # x is left where y is up and z the front, and also where z is up and -y the front.
    axes[2, front] = -1 if (side, up) == (0, 2) else 1
    axes[0] = np.cross(axes[1], axes[2])
    if _looks_back(nodes @ axes.T, tall):
        axes[[0, 2]] *= -1
    return axes


def lying(nodes: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return principal axes as rows: the widest way, the thinnest, and the longest to the front."""
    ways = np.linalg.svd(nodes - nodes.mean(axis=0), full_matrices=False)[2]
    axes = np.stack([ways[1], ways[2], ways[0]])
    if np.linalg.det(axes) < 0:
        axes[0] *= -1
    return axes


def _feet(nodes: NDArray[np.float64], axis: int) -> float:
    """Return how far what is lowest along an axis spreads, for the spread of all."""
    height = nodes[:, axis]
    low = nodes[height < height.min() + 0.06 * np.ptp(height)]
    others = [k for k in range(3) if k != axis]
    spread = np.ptp(low[:, others], axis=0) / np.maximum(np.ptp(nodes[:, others], axis=0), 1e-9)
    return float(spread.min())


def _looks_back(points: NDArray[np.float64], tall: bool) -> bool:
    """Return whether a body in its frame (n, 3) has its back where the frame has its front."""
    height = points[:, 1] - points[:, 1].min()
    total = float(np.ptp(points, axis=0).max())
    if tall:  # toes are before the ankles
        low, above = height < 0.03 * height.max(), (height > 0.06 * height.max())
        shin = above & (height < 0.14 * height.max())
        if not low.any() or not shin.any():
            return False
        middle = (points[low, 2].min() + points[low, 2].max()) / 2
        return bool(middle - np.median(points[shin, 2]) < -0.02 * total)
    high = points[height > 0.85 * height.max()]  # the head is above the front legs
    legs = points[height < 0.2 * height.max(), 2]
    return bool(np.median(high[:, 2]) < (legs.min() + legs.max()) / 2)


def mirrored(joints: Joints, size: float) -> Joints:
    """Return joints in a frame whose x is 0 in the middle, those of left and right alike.

    Left and right are returned unchanged if they have different poses.
    """
    flip, flat = np.array([-1.0, 1.0, 1.0]), np.array([0.0, 1.0, 1.0])
    pairs = [(name, f"{name[:-2]}.R") for name in joints if name.endswith(".L")]
    gaps = [float(np.linalg.norm(joints[a] - flip * joints[b])) for a, b in pairs]
    sides = {name for pair in pairs for name in pair}
    result = {name: at if name in sides else at * flat for name, at in joints.items()}
    if max(gaps, default=np.inf) <= SYMMETRIC_WITHIN * size:
        for a, b in pairs:
            result[a] = (joints[a] + flip * joints[b]) / 2
            result[b] = flip * result[a]
    return result
