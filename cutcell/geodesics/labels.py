"""What a node knows of its nearest joints: a few labels, each a joint, a distance and a bend.

Label s of node v is number v * k + s where a node has room for k. Anchors are looked at far more
often than the rest, and stand by themselves: those of a node fit into one line of memory.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ..compiled import compiled
from .queue import LOOSE

NOBODY, NOTHING = -1, -(2**31)
"""The joint and the anchor of a label that is not there."""

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
    """Make room for `each` labels a node; return them, and their anchors.

    An anchor is the label of the node where the path bends last, or ~bone.
    """
    labels = np.empty(nodes * each, LABEL)
    _empty(labels)
    return labels, np.full(nodes * each, NOTHING, np.int32)


@compiled
def _empty(labels):
    for label in range(len(labels)):
        labels[label].distance, labels[label].joint = np.inf, NOBODY
        labels[label].after = LOOSE
        labels[label].before = 0


@compiled(inline="always")
def find_room(labels, each, v, joint):
    """Return the label of a joint at node v or, if it has none, its farthest."""
    own, farthest, most = -1, v * each, 0.0
    for label in range(v * each, v * each + each):
        own = label if labels[label].joint == joint else own
        distance = labels[label].distance
        farthest = label if distance > most else farthest
        most = max(distance, most)
    return own if own >= 0 else farthest


@compiled(inline="always")
def follows_anchor(anchors, each, v, anchor):
    """Tell whether any label of node v has an anchor."""
    found = False
    for label in range(v * each, v * each + each):
        found |= anchors[label] == anchor
    return found
