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
"""Of the longest side: a joint this far from the body is told, and most likely wrong."""
SAME = 1e-5
"""Of the longest side: joints this near to each other lie in one place."""
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
            f"None of the {len(skeleton.joints)} joints hangs on another: they span no bones, and "
            "turning one moves no other.",
            "Give the joints their parents, if the program that moves them has any.",
            joints=np.arange(len(skeleton.joints)),
        )
    yield from _idle(subject)


def _outside(subject: Subject) -> Iterator[Finding]:
    moving = np.flatnonzero(subject.rig.skeleton.deform)
    away = subject.joint_distance[moving]
    found = away > OUTSIDE
    if not found.any():
        return
    far = away > FAR_OUTSIDE
    unit = subject.graph.lattice.size
    yield Finding(
        "joints-outside",
        "warning" if far.any() else "note",
        f"{count(int(found.sum()), 'joint', 'lie')} outside of the body, up to {away.max():.0%} of "
        "its longest side away, and may carry weight.",
        "Move them into the body, or let them carry no weight.",
        joints=moving[found],
        details=_named(
            subject, moving[found], [f"{a * unit:.3g} away" for a in away[found]]
        ),
    )  # fmt: skip


def _in_one_place(subject: Subject) -> Iterator[Finding]:
    skeleton = subject.rig.skeleton
    joints = subject.body.to_unit(skeleton.joints)
    held = np.flatnonzero(skeleton.parents >= 0)
    above = skeleton.parents[held]
    is_short = np.linalg.norm(joints[held] - joints[above], axis=1) <= SAME
    short = held[is_short & skeleton.deform[held] & skeleton.deform[above]]
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
    found = np.unique(pairs)
    if len(found):
        yield Finding(
            "coincident-joints",
            "note",
            f"{len(found)} joints that may carry weight are in the same position as others.",
            "Let one of each group carry weight: nothing tells which skin is whose.",
            joints=found,
            details=_named(subject, found, [""] * len(found)),
        )


def _is_link(parents: NDArray[np.int32], pairs: NDArray[np.intp]) -> NDArray[np.bool_]:
    one, other = pairs.T
    found: NDArray[np.bool_] = (parents[one] == other) | (parents[other] == one)
    return found


def _idle(subject: Subject) -> Iterator[Finding]:
    """Tell of joints that carry no weight: controls and markers, and bones that could."""
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
    """Return a line for each joint: its name, and what there is to say of it."""
    lines = [
        f"{_name(subject, j)}{': ' if note else ''}{note}"
        for j, note in zip(joints.tolist(), notes, strict=True)
    ]
    more = len(lines) - MAX_LINES
    return (*lines[:MAX_LINES], *([f"and {more} more"] if more > 0 else []))
