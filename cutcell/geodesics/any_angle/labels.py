"""Labels of nodes, and a queue of them by distance.

A label holds the distance of one of a node's nearest joints, and the path's parent vertex. With k
labels a node, label s of node v has the index v * k + s. Parents are read far more often than the
rest and are in a separate array: those of a node fit into one cache line.

The queue has buckets (Dial 1969). A bucket is a doubly linked list through the labels themselves:
a label is inserted and removed without a search, and with two integers of memory. Buckets are
served in order. Each is sorted when its turn comes; there are few labels in it, as it is narrow.
The first label of each bucket is in an array `head`, shape (buckets,), int32; `scale` is the number
of buckets a unit of distance. The last bucket holds everything beyond, until `move_on`.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ...geometry.vectors import TIE
from ...runtime.compiled import compiled

NO_JOINT, NO_PARENT = -1, -(2**31)
"""The joint and the parent of an unused label."""
END, LOOSE, SETTLED = -1, -2, -3
"""Values of `after` other than a label: last of its bucket, in no bucket, settled."""
SHIFT = 0.3
"""Of the buckets, whose bounds would else be at whole numbers of cells, where distances tie."""

LABEL = np.dtype(
    [
        ("distance", np.float64),
        ("joint", np.int32),
        ("after", np.int32),
        ("before", np.int32),
    ],
    align=True,
)
"""Joint: its rank. After and before: neighbours in a bucket; before the first is ~bucket."""


def no_labels(nodes: int, each: int) -> tuple[NDArray[np.void], NDArray[np.int32]]:
    """Return `each` unused labels a node, and their parents.

    A parent is the label of the node where the path bends last (Theta*), or ~bone.
    """
    labels = np.empty(nodes * each, LABEL)
    labels[:] = np.inf, NO_JOINT, LOOSE, 0
    return labels, np.full(nodes * each, NO_PARENT, np.int32)


@compiled(inline="always")
def find_room(labels, each, v, joint):
    """Return the label of a joint at node v or, if there is none, the farthest label.

    Of equally far ones, that of the last joint.
    """
    existing, farthest = -1, v * each
    for label in range(v * each, v * each + each):
        existing = label if labels[label].joint == joint else existing
        farther = labels[label].distance - labels[farthest].distance
        is_last = labels[label].joint > labels[farthest].joint
        farthest = label if farther > (-TIE if is_last else TIE) else farthest
    return existing if existing >= 0 else farthest


@compiled(inline="always")
def limit_of(labels, slot, joint):
    """Return the distance that a new label of a joint must be below to replace another joint's.

    Of equally near joints the first one stays.
    """
    if labels[slot].joint == joint:
        return labels[slot].distance
    return labels[slot].distance + (TIE if joint < labels[slot].joint else -TIE)


@compiled(inline="always")
def has_parent(parents, each, v, parent):
    """Return whether any label of node v has this parent."""
    is_parent = False
    for label in range(v * each, v * each + each):
        is_parent |= parents[label] == parent
    return is_parent


@compiled(inline="always")
def bucket_of(head, scale, distance):
    """Return the bucket of a distance."""
    return min(int(distance * scale + SHIFT), len(head) - 1)


@compiled(inline="always")
def join(head, labels, bucket, label):
    """Insert a label that is in no bucket."""
    _link(head, labels, ~bucket, label, head[bucket])


@compiled(inline="always")
def insert(head, labels, bucket, label, distance):
    """Insert a label that is in no bucket, by a distance, into a bucket that is sorted."""
    before, after = ~bucket, head[bucket]
    while after != END and labels[after].distance < distance:
        before, after = after, labels[after].after
    _link(head, labels, before, label, after)


@compiled(inline="always")
def sort(head, labels, bucket):
    """Sort the labels of a bucket by distance."""
    label, head[bucket] = head[bucket], END
    while label != END:
        follower = labels[label].after
        insert(head, labels, bucket, label, labels[label].distance)
        label = follower


@compiled(inline="always")
def _link(head, labels, before, label, after):
    labels[label].after, labels[label].before = after, before
    if before >= 0:
        labels[before].after = label
    else:
        head[~before] = label
    if after != END:
        labels[after].before = label


@compiled(inline="always")
def leave(head, labels, label):
    """Remove a label from its bucket, if it is in one."""
    after, before = labels[label].after, labels[label].before
    if after < END:
        return
    if before >= 0:
        labels[before].after = after
    else:
        head[~before] = after
    if after != END:
        labels[after].before = before
    labels[label].after = LOOSE


@compiled
def move_on(head, scale, labels):
    """Redistribute the last bucket over all; return the distance at which they begin."""
    label, origin = head[-1], np.inf
    while label != END:
        origin = min(origin, labels[label].distance)
        label = labels[label].after
    label, head[-1] = head[-1], END
    while label != END:
        follower = labels[label].after
        join(head, labels, bucket_of(head, scale, labels[label].distance - origin), label)
        label = follower
    return origin
