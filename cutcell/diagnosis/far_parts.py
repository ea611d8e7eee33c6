"""Parts of the mesh that rigidly follow a joint far from them."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from ..geodesics import BoneDistances
from ..geometry.segments import distance_to_segment
from ..runtime.display import shown_name
from .finding import Finding, count
from .subject import Subject

RIGID = 0.99
"""A part whose vertices all give more than this to one joint follows it rigidly."""
MIN_AWAY = 0.05
"""Of the longest side: how far every vertex of the part is from the bones of that joint."""
BEYOND = 0.1
"""Of the longest side: how much farther, in the median, that joint is than the nearest one."""
MAX_LINES = 40


def check_far_parts(subject: Subject) -> Iterator[Finding]:
    """Look for connected components that rigidly follow a joint far from them."""
    weights, distances = subject.rig.weights, subject.distances
    if weights is None or distances is None or not weights.any():
        return
    label = subject.component[subject.welded]
    sizes = np.bincount(label)
    number = np.argsort(np.argsort(-sizes, kind="stable"))  # the largest part is the first
    component = np.where(subject.is_used, number[label], -1)
    joint = np.where(weights.max(axis=1) > RIGID, weights.argmax(axis=1), -1)
    order = np.argsort(component, kind="stable")
    parts = np.split(order, np.flatnonzero(np.diff(component[order])) + 1)
    far = [
        (part, int(joint[part[0]]), nearest)
        for part in parts
        if component[part[0]] >= 0 and joint[part[0]] >= 0 and (joint[part] == joint[part[0]]).all()
        if (nearest := _much_nearer(subject, distances, part, int(joint[part[0]]))) >= 0
    ]
    if not far:
        return
    names = subject.rig.skeleton.names
    far.sort(key=lambda one: -len(one[0]))
    lines = tuple(
        f"Part {component[part[0]] + 1} ({count(len(part), 'vertex')}) follows "
        f"{shown_name(names[j])}; {shown_name(names[nearest])} is nearest"
        for part, j, nearest in far[:MAX_LINES]
    )
    yield Finding(
        "far-parts",
        "warning",
        f"{count(len(far), 'part', 'follow')} a joint that is far away, though another is near.",
        "Make each rigid to the nearest joint, unless it is meant to follow the other.",
        vertices=np.sort(np.concatenate([part for part, _, _ in far])),
        joints=np.unique([j for _, j, _ in far]),
        details=lines,
        parts=tuple((int(part.min()), nearest) for part, _, nearest in far),
    )


def _much_nearer(
    subject: Subject, distances: BoneDistances, part: NDArray[np.intp], joint: int
) -> int:
    """Return the joint nearest to a part, if it is much nearer than the one that it follows."""
    bones, points = distances.bones, subject.points[subject.welded[part]]
    allowed = subject.rig.allowed
    nearest, least, followed = -1, np.inf, np.full(len(points), np.inf)
    if not (bones.joint == joint).any():
        return -1
    for j in np.unique(bones.joint):
        if allowed is not None and not allowed[part, j].all():
            continue
        away = np.min(
            [
                distance_to_segment(points, bones.start[b], bones.end[b])
                for b in np.flatnonzero(bones.joint == j)
            ],
            axis=0,
        )
        if j == joint:
            followed = away
        if np.median(away) < least:
            nearest, least = int(j), float(np.median(away))
    is_far = followed.min() > MIN_AWAY and np.median(followed) - least > BEYOND
    return nearest if is_far else -1
