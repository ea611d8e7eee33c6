"""Labels of nodes: for each of a node's nearest joints the distance and the path's parent vertex.

With k labels a node, label s of node v has the index v * k + s. Parents are read far more often
than the rest and are in a separate array: those of a node fit into one cache line.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ...runtime.compiled import compiled
from .queue import LOOSE

NO_JOINT, NO_PARENT = -1, -(2**31)
"""The joint and the parent of an unused label."""

LABEL = np.dtype(
    [
        ("distance", np.float64),
        ("joint", np.int32),
        ("after", np.int32),
        ("before", np.int32),
    ],
    align=True,
)
"""Joint: its rank. After and before: neighbours in a bucket, see `queue`."""


def no_labels(nodes: int, each: int) -> tuple[NDArray[np.void], NDArray[np.int32]]:
    """Return `each` unused labels a node, and their parents.

    A parent is the label of the node where the path bends last (Theta*), or ~bone.
    """
    labels = np.empty(nodes * each, LABEL)
    labels[:] = np.inf, NO_JOINT, LOOSE, 0
    return labels, np.full(nodes * each, NO_PARENT, np.int32)


@compiled(inline="always")
def find_room(labels, each, v, joint):
    """Return the label of a joint at node v or, if there is none, the farthest label."""
    existing, farthest, most = -1, v * each, 0.0
    for label in range(v * each, v * each + each):
        existing = label if labels[label].joint == joint else existing
        distance = labels[label].distance
        farthest = label if distance > most else farthest
        most = max(distance, most)
    return existing if existing >= 0 else farthest


@compiled(inline="always")
def has_parent(parents, each, v, parent):
    """Return whether any label of node v has this parent."""
    is_parent = False
    for label in range(v * each, v * each + each):
        is_parent |= parents[label] == parent
    return is_parent
