"""Reference weights, from what a body was built of."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy import sparse
from scipy.sparse.csgraph import connected_components

from .body import Body
from .character import Bones

STEP = 4096
"""Weights are whole multiples of 1/4096: exact in float32, and their sums are exactly 1."""


def from_parts(
    body: Body,
    bones: Bones,
    vertices: NDArray,
    faces: NDArray,
    softness: float = 0.6,
    smoothing: int = 12,
) -> NDArray:
    """Blend each joint with its parent and children where their parts meet.

    A vertex belongs to the joint whose parts are nearest. Neighbours in the skeleton get a
    share that falls to 0 where their parts lie further by `softness` times the depth of the
    limb; limbs that only happen to be near get none. Then the shares are averaged along the
    surface.

    Returns
    -------
    array, shape (n, j)
        At most 4 joints a vertex; rows sum to 1.
    """
    distances = body.joint_distances(vertices, bones.names)
    home = _homes(distances, faces, bones)
    width = softness * _limb_radii(body, bones)[home]
    excess = distances - distances[np.arange(len(home)), home][:, None]
    share = np.clip(1 - excess / width[:, None], 0, 1)
    share = share * share * bones.neighbours()[home]
    share /= share.sum(axis=1, keepdims=True)
    return quantised(_averaged(share, faces, smoothing))


def quantised(weights: NDArray, influences: int = 4) -> NDArray:
    """Keep the largest few of each row, as whole multiples of 1/4096 that sum to 1."""
    order = np.argsort(-np.round(weights, 9), axis=1, kind="stable")[:, :influences]
    largest = np.take_along_axis(weights, order, axis=1)
    largest = np.floor(largest / largest.sum(axis=1, keepdims=True) * STEP + 1e-6)
    largest[largest < STEP * 0.01] = 0
    largest[:, 0] += STEP - largest.sum(axis=1)
    result = np.zeros_like(weights)
    np.put_along_axis(result, order, largest / STEP, axis=1)
    return result


def rigid(count: int, bones: Bones, joint: str) -> NDArray:
    """Return weights (count, j) that hold everything on one joint."""
    weights = np.zeros((count, len(bones.names)))
    weights[:, bones.names.index(joint)] = 1
    return weights


def _homes(distances: NDArray, faces: NDArray, bones: Bones) -> NDArray:
    """Return each vertex's nearest joint, not counting limbs that only lie close by.

    Where parts melt, the surface stands off from all of them, and the ear above the back can
    be nearer than the back's own parts. But that patch is away from the rest of the ear: a
    joint's patches count if they touch its largest one, or that of a parent or child.
    """
    distances, neighbours = distances.copy(), bones.neighbours()
    start, end = faces.ravel(), np.roll(faces, -1, axis=1).ravel()
    while True:
        home = distances.argmin(axis=1)
        inner = home[start] == home[end]
        links = sparse.coo_array(
            (np.ones(inner.sum()), (start[inner], end[inner])), shape=(len(home),) * 2
        )
        count, patch = connected_components(links, directed=False)
        size = np.bincount(patch)
        joint = np.zeros(count, int)
        joint[patch] = home
        main = np.zeros(count, bool)
        order = np.lexsort((size, joint))
        main[order[np.diff(joint[order], append=-1) != 0]] = True
        a, b = patch[start], patch[end]
        covered = main.copy()
        covered[a[main[b] & neighbours[joint[a], joint[b]]]] = True
        stray = ~covered[patch]
        if not stray.any():
            return home
        distances[stray, home[stray]] = np.inf


def _limb_radii(body: Body, bones: Bones) -> NDArray:
    """Return how deep each joint's parts are at the most: minus the least distance inside."""
    radii = np.zeros(len(bones.names))
    for part in body.parts:
        if part.carve:
            continue
        k = bones.names.index(part.joint)
        steps = np.linspace(-0.9, 0.9, 7)
        cube = np.stack(np.meshgrid(steps, steps, steps), axis=-1).reshape(-1, 3)
        probes = part.shape.centre + cube * part.shape.radius
        radii[k] = max(radii[k], -float(part.shape.distance(probes).min()))
    return np.maximum(radii, 1e-3)


def _averaged(values: NDArray, faces: NDArray, times: int) -> NDArray:
    count = len(values)
    start, end = faces.ravel(), np.roll(faces, -1, axis=1).ravel()
    order = np.argsort(start, kind="stable")
    start, end = start[order], end[order]
    first = np.searchsorted(start, np.arange(count))
    degree = np.bincount(start, minlength=count)[:, None]
    for _ in range(times):
        values = (values + np.add.reduceat(values[end], first, axis=0) / degree) / 2
    return values
