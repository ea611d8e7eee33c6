"""Skeletons with other joints, names and parents than in their file: `restructured`."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from ..errors import ParameterError, SkeletonError
from ..rig import Clip, Rig, Skeleton, with_origin
from ..rig.clip import Rebased
from ..runtime.display import shown_name
from .edits import Edits
from .locks import joint_index


def restructured(rig: Rig, edits: Edits) -> Rig:
    """Return a rig whose joints are added, removed, renamed and reparented by edits.

    Joints of the file come first, in its order. Weights of a removed joint go to its nearest
    remaining ancestor, or else to its first remaining descendant. A joint of the file
    keeps its motion relative to its parent; added joints do not move relative to theirs, and the
    motion of removed joints is dropped.

    A rig to which the same edits were applied is returned as it is; others are refused, for
    the weights and clips that they would start from are gone.
    """
    if not edits.structural:
        return rig
    old = rig.original or rig.skeleton
    skeleton, origin = restructured_skeleton(old, edits)
    if rig.origin is not None:
        same = np.array_equal(rig.origin, origin) and skeleton.names == rig.skeleton.names
        if not same or not np.array_equal(skeleton.parents, rig.skeleton.parents):
            raise ParameterError(
                f"{rig.name} already has other edits of its joints; apply all edits at "
                "once to the rig as it was loaded"
            )
        return rig
    removed = ~np.isin(np.arange(len(old.joints)), origin)
    heir = _heirs(old, removed)
    number = np.maximum(np.cumsum(~removed) - 1, 0)
    weights = rig.weights
    if weights is not None:
        moved = np.zeros((len(weights), len(origin)))
        np.add.at(moved.T, number[heir], weights.T)
        weights = moved
    allowed = rig.allowed
    if allowed is not None:
        allowed = allowed[:, [max(int(origin[j]), 0) for j in with_origin(skeleton, origin)]]
    after = old.parents, skeleton.parents, origin, np.zeros((len(origin), 3))
    return replace(
        rig,
        skeleton=skeleton,
        weights=weights,
        allowed=allowed,
        clips=tuple(Clip(one.name, motion=Rebased(one.motion, *after)) for one in rig.clips),
        attachments=tuple(
            replace(one, joint=int(number[heir[one.joint]])) for one in rig.attachments
        ),
        origin=origin.astype(np.int32),
        original=old,
    )


def restructured_skeleton(old: Skeleton, edits: Edits) -> tuple[Skeleton, NDArray[np.int_]]:
    """Return the skeleton that edits make, its joints where they were, and their origin.

    Returns shapes origin (j,).
    """
    if not edits.structural:
        return old, np.arange(len(old.joints))
    removed = np.zeros(len(old.joints), np.bool_)
    for name in edits.removed:
        removed[joint_index(old, name)] = True
    names = _names(old, removed, edits)
    staying = np.flatnonzero(~removed)
    origin = np.concatenate([staying, np.full(len(names) - len(staying), -1)])
    if not len(origin):
        raise SkeletonError("by the edits no joint of the skeleton is left; keep at least one")
    return _skeleton(old, removed, names, origin, edits), origin


def _names(old: Skeleton, removed: NDArray[np.bool_], edits: Edits) -> list[str]:
    """Return the names of the joints that stay, and of those that are added."""
    now = list(old.names)
    fresh = []
    for name, one in edits.joints.items():
        if one.was is not None:
            joint = joint_index(old, one.was)
            if removed[joint]:
                raise ParameterError(f'edits both remove and rename the joint "{one.was}"')
            now[joint] = name
        if one.was is not None or one.added:
            fresh.append(name)
    names = [now[joint] for joint in np.flatnonzero(~removed)]
    names += [name for name, one in edits.joints.items() if one.added]
    for name in fresh:
        if not name.strip():
            raise SkeletonError("a joint needs a name")
        if names.count(name) > 1:
            raise SkeletonError(
                f'two joints would be called "{shown_name(name)}"; choose another name for one'
            )
    return names


def _skeleton(
    old: Skeleton,
    removed: NDArray[np.bool_],
    names: list[str],
    origin: NDArray[np.int_],
    edits: Edits,
) -> Skeleton:
    """Return the new skeleton; joints of the file keep their positions."""
    staying, count = origin[origin >= 0], len(names)
    parents = np.full(count, -1)
    number = np.cumsum(~removed) - 1
    for j, was in enumerate(staying):
        above = _remaining(old, removed, old.parents[was])
        parents[j] = number[above] if above >= 0 else -1
    joints, deform = np.zeros((count, 3)), np.ones(count, np.bool_)
    joints[: len(staying)], deform[: len(staying)] = old.joints[staying], old.deform[staying]
    for j, name in enumerate(names):
        one = edits.joints.get(name)
        if one is None:
            continue
        if one.parent is not None:
            if one.parent and one.parent not in names:
                raise ParameterError(
                    f'"{shown_name(name)}" is to hang on "{shown_name(one.parent)}", but there is '
                    "no such joint"
                )
            parents[j] = names.index(one.parent) if one.parent else -1
        if one.added:
            joints[j] = one.position
    plain = Skeleton(joints, parents, names, deform)  # refuses circles
    if old.orientations is None:
        return plain
    axes = np.tile(np.eye(3), (count, 1, 1))
    like = with_origin(plain, origin)
    from_file = origin[like] >= 0
    axes[from_file] = old.orientations[origin[like[from_file]]]
    return replace(plain, orientations=axes)


def _remaining(old: Skeleton, removed: NDArray[np.bool_], joint: int) -> int:
    """Return a joint or its nearest ancestor that is not removed; -1 for none."""
    while joint >= 0 and removed[joint]:
        joint = int(old.parents[joint])
    return joint


def _heirs(old: Skeleton, removed: NDArray[np.bool_]) -> NDArray[np.int_]:
    """Return the joint that takes over from each joint of the file: itself where it stays."""
    heir = np.arange(len(old.joints))
    for j in np.flatnonzero(removed):
        heir[j] = _remaining(old, removed, int(j))
        if heir[j] < 0:
            below = np.flatnonzero(old.subtree[j] & ~removed)
            heir[j] = below[0] if len(below) else (~removed).argmax()
    return heir
