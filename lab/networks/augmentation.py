"""Random changes of a sample for one epoch of training.

Points, heading and size always change. Augmentation also leaves out joints and parts, poses the
rig, and draws points by area instead of by vertex, as between artists and files.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components
from scipy.spatial.transform import Rotation

from cutcell.pose import forward_kinematics, linear_blend_skinning
from cutcell.rig import Skeleton

from .samples import Sample

SCALES = 0.8, 1.25
"""Range of random scales of a character."""
LESS_SURFACE, FEWER_JOINTS, OTHER_POSE, BY_AREA = 0.25, 0.5, 0.5, 0.5
"""How often each is done."""
MAX_LEFT_OUT = 0.5
"""Largest share of the joints with a parent that are left out."""
LARGEST_PART, HOLE = 0.5, 0.15
"""Of the points: a component that is dropped has at most so many, a hole about so many."""
DEGREES = 15.0
"""Standard deviation of a joint's turn about each axis."""
CLOSEST = 1e-3
"""Points closer than this, in longest sides, count as if they were so far apart."""


def drawn(sample: Sample, points: int, rng: np.random.Generator, augment: bool = False) -> Sample:
    """Return random points of a sample, turned about the vertical and scaled at random."""
    if augment:
        sample = _with_less_surface(sample, rng)
        sample = sample.part(_spread(sample, points, rng))
        sample = _in_another_pose(_with_fewer_joints(sample, rng), rng)
    else:
        sample = sample.part(rng.permutation(len(sample.points))[:points])
    turn = _about_vertical(rng.uniform(0, 2 * np.pi))
    return _moved(sample, turn, np.exp(rng.uniform(*np.log(SCALES))))


def without_joints(sample: Sample, left_out: NDArray[np.bool_]) -> Sample:
    """Return the sample with a sparser skeleton.

    The weight of a joint that is left out, and its share of the prior, go to the nearest ancestor
    that is kept: an artist without that joint would have painted its part for the joint above.

    Shapes: left_out (j,).
    """
    parents, count = sample.parents, len(sample.parents)
    keep = ~np.asarray(left_out) | (parents < 0)
    heir = np.arange(count)
    while (out := ~keep[heir]).any():
        heir[out] = parents[heir[out]]
    staying = np.flatnonzero(keep)
    place = np.full(count, -1)
    place[staying] = np.arange(len(staying))
    above = parents[staying]
    parent = np.where(above >= 0, place[heir[above]], -1)
    tails = sample.tails[staying]
    for joint in np.unique(place[heir[parents[~keep]]]):
        children = staying[parent == joint]
        ends = children if len(children) else staying[[joint]]
        tails[joint] = sample.joints[ends].mean(axis=0)
    into = np.zeros((count, len(staying)), np.float32)
    into[np.arange(count), place[heir]] = 1
    return replace(
        sample,
        joints=sample.joints[staying],
        tails=tails,
        parents=parent,
        prior=None if sample.prior is None else sample.prior @ into,
        target=None if sample.target is None else sample.target @ into,
        deform=sample.deform[staying],
    )


def posed(sample: Sample, rotations: NDArray) -> Sample:
    """Return the sample in another pose, by the artist's weights.

    Prior and neighbours stay: they are measured through the body and along its surface, which move
    with the pose. Points without weight do not move.

    Shapes: rotations (j, 3, 3).
    """
    assert sample.target is not None
    turns = forward_kinematics(Skeleton(sample.joints, sample.parents), rotations)
    normals = linear_blend_skinning(sample.normals, sample.target, _turned_only(turns))
    length = np.linalg.norm(normals, axis=1, keepdims=True)
    identity = np.eye(len(turns))
    return replace(
        sample,
        points=linear_blend_skinning(sample.points, sample.target, turns).astype(np.float32),
        normals=(normals / np.maximum(length, 1e-9)).astype(np.float32),
        joints=linear_blend_skinning(sample.joints, identity, turns).astype(np.float32),
        tails=linear_blend_skinning(sample.tails, identity, turns).astype(np.float32),
    )


def components(sample: Sample) -> NDArray[np.int32]:
    """Return the connected component of each point in the graph of neighbours, shape (p,)."""
    count = len(sample.points)
    one = np.repeat(np.arange(count), sample.neighbours.shape[1])
    links = coo_array((np.ones(len(one)), (one, sample.neighbours.ravel())), shape=(count, count))
    return connected_components(links, directed=False)[1]


def surface_shares(sample: Sample) -> NDArray[np.float64]:
    """Return the area around each point, shape (p,), up to a factor: its ring's radius squared."""
    away = np.linalg.norm(sample.points[sample.ring] - sample.points[:, None], axis=2)
    return np.maximum(away.max(axis=1), CLOSEST).astype(np.float64) ** 2


def _with_less_surface(sample: Sample, rng: np.random.Generator) -> Sample:
    """Drop a component at random, or cut a hole if there is none to drop."""
    if rng.random() >= LESS_SURFACE:
        return sample
    label = components(sample)
    small = np.flatnonzero(np.bincount(label) <= LARGEST_PART * len(label))
    if len(small):
        gone = label == rng.choice(small)
    else:
        gone = np.zeros(len(label), bool)
        size = max(1, round(HOLE * len(label)))
        gone[sample.neighbours[rng.integers(len(label)), :size]] = True
    return sample.part(np.flatnonzero(~gone))


def _spread(sample: Sample, points: int, rng: np.random.Generator) -> NDArray[np.int64]:
    """Draw points uniformly over the vertices, or over the surface."""
    if rng.random() >= BY_AREA:
        return rng.permutation(len(sample.points))[:points]
    shares = surface_shares(sample)
    count = min(points, len(shares))
    return rng.choice(len(shares), count, replace=False, p=shares / shares.sum())


def _with_fewer_joints(sample: Sample, rng: np.random.Generator) -> Sample:
    if rng.random() >= FEWER_JOINTS:
        return sample
    share = rng.uniform(0, MAX_LEFT_OUT)
    return without_joints(sample, rng.random(len(sample.parents)) < share)


def _in_another_pose(sample: Sample, rng: np.random.Generator) -> Sample:
    if rng.random() >= OTHER_POSE:
        return sample
    turns = rng.normal(0, np.radians(DEGREES), (len(sample.parents), 3))
    return posed(sample, Rotation.from_rotvec(turns).as_matrix())


def _about_vertical(angle: float) -> NDArray[np.float64]:
    cos, sin = np.cos(angle), np.sin(angle)
    return np.array([[cos, 0, sin], [0, 1, 0], [-sin, 0, cos]])


def _moved(sample: Sample, turn: NDArray, scale: float) -> Sample:
    def moved(places: NDArray, by: float) -> NDArray[np.float32]:
        return (by * places @ turn.T).astype(np.float32)

    return replace(
        sample,
        points=moved(sample.points, scale),
        normals=moved(sample.normals, 1),
        joints=moved(sample.joints, scale),
        tails=moved(sample.tails, scale),
    )


def _turned_only(transforms: NDArray) -> NDArray[np.float64]:
    """Return the transforms (j, 4, 4) without what they move by."""
    turns = transforms.copy()
    turns[:, :3, 3] = 0
    return turns
