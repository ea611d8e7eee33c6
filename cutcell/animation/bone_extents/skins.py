"""Joints that belong together: those of one skin, and those of one character."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray
from scipy.sparse.csgraph import connected_components

from ...rig import Skeleton


def share_a_skin(allowed: NDArray[np.bool_] | None, joints: int) -> NDArray[np.bool_]:
    """Return which joints some vertex may follow both, shape (j, j); see `Rig.allowed`.

    Shapes: allowed (n, j).
    """
    if allowed is None:
        return np.ones((joints, joints), np.bool_)
    # The vertices of a skin follow each other in a file.
    first = np.flatnonzero(np.diff(allowed, axis=0, prepend=~allowed[:1]).any(axis=1))
    skins = allowed[first].astype(np.float32)
    return np.asarray(skins.T @ skins > 0) | np.eye(joints, dtype=np.bool_)


def characters(
    skeleton: Skeleton, together: NDArray[np.bool_]
) -> Iterator[tuple[NDArray[np.intp], Skeleton]]:
    """Yield the joints of each character, ascending, and a skeleton of these alone.

    Joints of one skin are of one character, and so are a parent and its child.

    Shapes: together (j, j).
    """
    parents = skeleton.parents
    linked = together.copy()
    child = np.flatnonzero(parents >= 0)
    linked[child, parents[child]] = True
    count, label = connected_components(linked, directed=False)
    if count == 1:
        yield np.arange(len(parents)), skeleton
        return
    number = np.full(len(parents) + 1, -1, np.int32)
    for character in range(count):
        joints = np.flatnonzero(label == character)
        if not skeleton.deform[joints].any():
            continue
        number[joints] = np.arange(len(joints))
        axes = None if skeleton.orientations is None else skeleton.orientations[joints]
        names = [skeleton.names[j] for j in joints]
        yield (
            joints,
            Skeleton(
                skeleton.joints[joints],
                number[parents[joints]],
                names,
                skeleton.deform[joints],
                axes,
            ),
        )
