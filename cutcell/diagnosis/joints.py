"""Faults of the skeleton."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from scipy.spatial import cKDTree

from .finding import Finding, finding_of
from .subject import Subject

NOTED_OUTSIDE, WARNED_OUTSIDE = 0.05, 0.15
"""Distances from the body of a note and of a warning, as parts of the longest side."""
COINCIDENT_JOINTS = 1e-5
"""Distance of coincident joints, as part of the longest side."""


def check_joints(subject: Subject) -> Iterator[Finding]:
    """Look for faults of the skeleton."""
    skeleton = subject.rig.skeleton
    if not len(skeleton.joints):
        return
    yield from _outside(subject)
    yield from _in_one_place(subject)
    if len(skeleton.joints) > 2 and (skeleton.parents < 0).all():
        every = np.arange(len(skeleton.joints))
        yield from finding_of("flat-hierarchy", joints=every, number=len(every))
    yield from _idle(subject)


def _outside(subject: Subject) -> Iterator[Finding]:
    moving = np.flatnonzero(subject.rig.skeleton.deform)
    away = subject.joint_distance[moving]
    outside = away > NOTED_OUTSIDE
    unit = subject.graph.lattice.size
    yield from finding_of(
        "joints-outside",
        severity="warning" if (away > WARNED_OUTSIDE).any() else "note",
        joints=moving[outside],
        details=[
            f"{subject.name(j)}: {a * unit:.3g} away"
            for j, a in zip(moving[outside], away[outside], strict=True)
        ],
        away=away.max(initial=0),
    )


def _in_one_place(subject: Subject) -> Iterator[Finding]:
    skeleton, name = subject.rig.skeleton, subject.name
    joints = subject.body.to_unit(skeleton.joints)
    children = np.flatnonzero(skeleton.parents >= 0)
    above = skeleton.parents[children]
    is_short = np.linalg.norm(joints[children] - joints[above], axis=1) <= COINCIDENT_JOINTS
    short = children[is_short & skeleton.deform[children] & skeleton.deform[above]]
    details = [f'{name(j)}: on "{name(skeleton.parents[j])}"' for j in short]
    yield from finding_of("zero-length-bones", joints=short, details=details)
    moving = np.flatnonzero(skeleton.deform)
    pairs = moving[cKDTree(joints[moving]).query_pairs(COINCIDENT_JOINTS, output_type="ndarray")]
    is_link = (skeleton.parents[pairs] == pairs[:, ::-1]).any(axis=1)
    same = np.unique(pairs[~is_link])
    details = [*map(name, same)]
    yield from finding_of("coincident-joints", joints=same, details=details, number=len(same))


def _idle(subject: Subject) -> Iterator[Finding]:
    """Find joints without weight: controls and markers, and bones that could have some."""
    rig, guess = subject.rig, subject.guess
    controls = np.flatnonzero(~guess.deform & ~rig.skeleton.deform)
    details = [f"{subject.name(j)}: {guess.reason[j]}" for j in controls]
    yield from finding_of("control-joints", joints=controls, details=details)
    if rig.weights is not None:
        unused = np.flatnonzero(guess.deform & ~rig.skeleton.deform)
        yield from finding_of("unused-joints", joints=unused, details=[*map(subject.name, unused)])
