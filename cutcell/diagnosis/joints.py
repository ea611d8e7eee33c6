"""Faults of the skeleton."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from ..runtime.display import shown_name
from .finding import Finding, count
from .subject import Subject

OUTSIDE, FAR_OUTSIDE = 0.05, 0.15
"""Distances from the body of a note and of a warning, as parts of the longest side."""
SAME = 1e-5
"""Distance of coincident joints, as part of the longest side."""
MAX_LINES = 40


def check_joints(subject: Subject) -> Iterator[Finding]:
    """Look for faults of the skeleton."""
    skeleton = subject.rig.skeleton
    if not len(skeleton.joints):
        return
    yield from _outside(subject)
    yield from _in_one_place(subject)
    if len(skeleton.joints) > 2 and (skeleton.parents < 0).all():
        yield Finding(
            "flat-hierarchy",
            "note",
            f"None of the {len(skeleton.joints)} joints has a parent: they span no bones, and "
            "turning one moves no other.",
            "Give the joints their parents, if the program that moves them has any.",
            joints=np.arange(len(skeleton.joints)),
        )
    yield from _idle(subject)


def _outside(subject: Subject) -> Iterator[Finding]:
    moving = np.flatnonzero(subject.rig.skeleton.deform)
    away = subject.joint_distance[moving]
    is_outside = away > OUTSIDE
    if not is_outside.any():
        return
    far = away > FAR_OUTSIDE
    unit = subject.graph.lattice.size
    yield Finding(
        "joints-outside",
        "warning" if far.any() else "note",
        f"{count(int(is_outside.sum()), 'joint', 'lie')} outside of the body, up to "
        f"{away.max():.0%} of its longest side away, and may carry weight.",
        "Move them into the body, or let them carry no weight.",
        joints=moving[is_outside],
        details=_named(
            subject, moving[is_outside], [f"{a * unit:.3g} away" for a in away[is_outside]]
        ),
    )  # fmt: skip


def _in_one_place(subject: Subject) -> Iterator[Finding]:
    skeleton = subject.rig.skeleton
    joints = subject.body.to_unit(skeleton.joints)
    children = np.flatnonzero(skeleton.parents >= 0)
    above = skeleton.parents[children]
    is_short = np.linalg.norm(joints[children] - joints[above], axis=1) <= SAME
    short = children[is_short & skeleton.deform[children] & skeleton.deform[above]]
    if len(short):
        yield Finding(
            "zero-length-bones",
            "note",
            f"{count(len(short), 'joint', 'lie')} exactly on the parent.",
            "Move one of the two, or let only one carry weight.",
            joints=short,
            details=_named(
                subject, short, [f'on "{_name(subject, skeleton.parents[j])}"' for j in short]
            ),
        )
    moving = np.flatnonzero(skeleton.deform)
    pairs = moving[cKDTree(joints[moving]).query_pairs(SAME, output_type="ndarray")]
    pairs = pairs[~_is_link(skeleton.parents, pairs)]
    coincident = np.unique(pairs)
    if len(coincident):
        yield Finding(
            "coincident-joints",
            "note",
            f"{len(coincident)} joints that may carry weight are in the same position as others.",
            "Let one of each group carry weight: the skin is divided arbitrarily between them.",
            joints=coincident,
            details=_named(subject, coincident, [""] * len(coincident)),
        )


def _is_link(parents: NDArray[np.int32], pairs: NDArray[np.intp]) -> NDArray[np.bool_]:
    one, other = pairs.T
    is_link: NDArray[np.bool_] = (parents[one] == other) | (parents[other] == one)
    return is_link


def _idle(subject: Subject) -> Iterator[Finding]:
    """Find joints without weight: controls and markers, and bones that could have some."""
    rig, guess = subject.rig, subject.guess
    controls = np.flatnonzero(~guess.deform & ~rig.skeleton.deform)
    if len(controls):
        yield Finding(
            "control-joints",
            "note",
            f"{count(len(controls), 'joint', 'move')} no skin: controls, end markers, sockets and "
            "roots.",
            "No action needed. Let one carry weight if it is a bone after all.",
            joints=controls,
            details=_named(subject, controls, [guess.reason[j] for j in controls]),
        )
    if rig.weights is None:
        return
    unused = np.flatnonzero(guess.deform & ~rig.skeleton.deform)
    if len(unused):
        yield Finding(
            "unused-joints",
            "note",
            f"{count(len(unused), 'joint', 'carry')} no weight in the file, though in or near the "
            "body.",
            "No action needed if they are helpers. Binding leaves them without weight, too.",
            joints=unused,
            details=_named(subject, unused, [""] * len(unused)),
        )


def _name(subject: Subject, joint: int) -> str:
    return shown_name(subject.rig.skeleton.names[joint])


def _named(subject: Subject, joints: NDArray[np.intp], notes: list[str]) -> tuple[str, ...]:
    """Return a line for each joint: its name and a note."""
    lines = [
        f"{_name(subject, j)}{': ' if note else ''}{note}"
        for j, note in zip(joints.tolist(), notes, strict=True)
    ]
    more = len(lines) - MAX_LINES
    return (*lines[:MAX_LINES], *([f"and {more} more"] if more > 0 else []))
