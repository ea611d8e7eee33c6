"""What a node knows of its nearest joints: a few labels, each a joint, a distance and a bend.

One label is one record, and those of a node follow one another: looking at a node takes one
or two lines of memory.
"""

from __future__ import annotations

import numpy as np
from numba import njit
from numpy.typing import NDArray

from .queue import LOOSE

NOBODY, NOTHING = -1, -(2**31)
"""The joint and the anchor of a label that is not there."""

LABEL = np.dtype(
    [
        ("distance", np.float64),
        ("joint", np.int32),
        ("anchor", np.int32),
        ("after", np.int32),
        ("before", np.int32),
    ],
    align=True,
)
"""Joint: its rank. Anchor: the label of the node where the path bends last, or ~bone. After
and before: neighbours in a bucket, see `queue`."""


def no_labels(nodes: int, each: int) -> NDArray[np.void]:
    """Make room for `each` labels a node; label s of node v is number v * each + s."""
    labels = np.empty(nodes * each, LABEL)
    _empty(labels)
    return labels


@njit(cache=True, nogil=True)
def _empty(labels):
    for label in range(len(labels)):
        labels[label].distance, labels[label].joint = np.inf, NOBODY
        labels[label].anchor, labels[label].after = NOTHING, LOOSE
        labels[label].before = 0


@njit(cache=True, inline="always")
def find_room(labels, each, v, joint, anchor):
    """Return the label of a joint at node v or, if it has none, its farthest.

    -1 if v follows the anchor already: most often so, hence no exit from the loop that the
    processor would have to guess.
    """
    follows, own = False, -1
    for label in range(v * each, v * each + each):
        follows |= labels[label].anchor == anchor
        own = label if labels[label].joint == joint else own
    if follows:
        return -1
    if own >= 0:
        return own
    farthest, most = v * each, 0.0
    for label in range(v * each, v * each + each):
        distance = labels[label].distance
        farthest = label if distance > most else farthest
        most = max(distance, most)
    return farthest


@njit(cache=True, inline="always")
def follows_anchor(labels, each, v, anchor):
    """Tell whether any label of node v has an anchor."""
    found = False
    for label in range(v * each, v * each + each):
        found |= labels[label].anchor == anchor
    return found


@njit(cache=True, inline="always")
def least_distance(labels, each, v):
    """Return the distance of a node's nearest joint."""
    least = np.inf
    for label in range(v * each, v * each + each):
        least = min(least, labels[label].distance)
    return least
