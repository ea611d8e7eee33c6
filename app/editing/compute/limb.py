"""The middle of the body around a joint."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from cutcell.checks import check_integer
from cutcell.errors import SkeletonError
from cutcell.graph.winding import winding_number
from cutcell.rig import Rig, Skeleton
from cutcell_viewers.plane_section import plane_outline

DIRECTIONS = 96
"""In the plane across the limb, in which the skin is looked for."""
ROUNDS = 16
"""Iterations: the centroid of the section visible from a point is nearer to the centre."""
FARTHEST = 2.0
"""Times the lower quartile of the distances to the skin: where a limb opens into the trunk, what is
farther is the trunk's."""
MIN_HIT_SHARE = 0.75
"""Minimum share of the directions that must meet skin."""


def cross_section_centre(rig: Rig, joint: int) -> NDArray[np.float64]:
    """Find the centre of the limb's cross-section at a joint.

    It is the centroid of the section by the plane through the joint across its bones, as far as it
    is visible from the joint: other limbs in the plane are ignored.

    Parameters
    ----------
    rig : Rig
    joint : int

    Returns
    -------
    array, shape (3,), float64
        In the file's units.

    Raises
    ------
    ParameterError
        There is no such joint.
    SkeletonError
        The joint is not in the body.
    """
    joint = check_integer("joint", joint, 0, len(rig.skeleton.joints) - 1)
    place, out = rig.skeleton.joints[joint], _along(rig.skeleton, joint)
    side = np.cross(out, np.eye(3)[np.abs(out).argmin()])
    plane = np.stack([side, np.cross(out, side)]) / np.linalg.norm(side)
    outline = plane_outline(rig.mesh.vertices - place, rig.mesh.faces, np.zeros(3), out)
    # Not by a matrix product: segments that share an end must have the same numbers for it, so
    # that nothing passes between them.
    start, end = np.stack([(outline * axis).sum(axis=2) for axis in plane], axis=2).swapaxes(0, 1)
    middle, most = np.zeros(2), np.inf
    inside = bool(winding_number(rig.mesh, place[None])[0] > 0.5)
    for _ in range(ROUNDS):
        skin = _visible_section(start - middle, end - middle)
        if not inside or len(skin) < MIN_HIT_SHARE * DIRECTIONS:
            raise SkeletonError(
                f'joint "{rig.skeleton.names[joint]}" is not in the body, so that there is no limb '
                "around it; move it into the body first"
            )
        most = most if np.isfinite(most) else float(np.median(np.linalg.norm(skin, axis=1)))
        middle = middle + _centroid(skin)
        if np.linalg.norm(middle) > most:  # it leaves the limb for the trunk
            middle *= most / np.linalg.norm(middle)
            break
    return np.asarray(place + middle @ plane)


def _along(skeleton: Skeleton, joint: int) -> NDArray[np.float64]:
    """Return the direction of the bones at a joint, of length 1: in by one, out by the others."""
    place, parent = skeleton.joints[joint], skeleton.parents[joint]
    children = skeleton.joints[skeleton.children[joint]]
    displacements = [children.mean(axis=0) - place] if len(children) else []
    displacements += [place - skeleton.joints[parent]] if parent >= 0 else []
    units = [
        direction / np.linalg.norm(direction) for direction in displacements if direction.any()
    ]
    total = np.sum(units, axis=0) if units else np.zeros(3)
    length = float(np.linalg.norm(total))
    if length > 1e-3:
        return np.asarray(total / length)
    return np.asarray(units[0]) if units else np.array([0.0, 1.0, 0.0])


def _visible_section(start: NDArray[np.float64], end: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the nearest points of segments (s, 2) in each direction from 0, as far as any is."""
    angle = 2 * np.pi * np.arange(DIRECTIONS) / DIRECTIONS
    direction = np.stack([np.cos(angle), np.sin(angle)], axis=1)
    before, after = _cross(direction[:, None], start), _cross(direction[:, None], end)
    with np.errstate(divide="ignore", invalid="ignore"):
        far = _cross(start, end) / (after - before)
    passed = (before < 0) != (after < 0)
    far = np.where(passed & (far > 0), far, np.inf).min(axis=1, initial=np.inf)
    hit = np.isfinite(far)
    if hit.any():
        far = np.minimum(far, FARTHEST * np.quantile(far[hit], 0.25))
    return direction[hit] * far[hit, None]


def _centroid(corners: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the centroid of a polygon (k, 2) around 0."""
    after = np.roll(corners, -1, axis=0)
    area = _cross(corners, after)
    return np.asarray((area[:, None] * (corners + after)).sum(axis=0) / (3 * area.sum()))


def _cross(a: NDArray[np.float64], b: NDArray[np.float64]) -> NDArray[np.float64]:
    return np.asarray(a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0])
