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
from numba import config
from numpy.typing import NDArray

from ...geometry.vectors import TIE
from ...runtime.compiled import compiled

UNUSED_JOINT, NO_PARENT = -1, -(2**31)
"""The joint and the parent of an unused label."""
BEFORE_ALL = -np.inf
END, LOOSE, SETTLED = -1, -2, -3
"""Values of `after` other than a label: last of its bucket, in no bucket, settled."""
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
    make = np.recarray if vars(config)["DISABLE_JIT"] else np.empty  # without attributes
    labels = make(nodes * each, LABEL)
    _empty(labels)
    return labels, np.full(nodes * each, NO_PARENT, np.int32)


@compiled
def _empty(labels):
    """Make labels unused, field by field: numpy would go through them once for each field."""
    for label in range(len(labels)):
        labels[label].distance, labels[label].joint = np.inf, UNUSED_JOINT
        labels[label].after, labels[label].before = LOOSE, 0


@compiled(inline="always")
def find_room(labels, each, v, joint):
    """Return the label of a joint at node v or, if there is none, the last of the farthest."""
    existing, farthest = -1, v * each
    for label in range(v * each, v * each + each):
        existing = label if labels[label].joint == joint else existing
        limit = TIE if labels[label].joint < labels[farthest].joint else -TIE
        farthest = label if labels[label].distance > labels[farthest].distance + limit else farthest
    return existing if existing >= 0 else farthest


@compiled(inline="always")
def limit_of(labels, slot, joint):
    """Return the distance that a joint's must be below to replace a label: equals go by joint."""
    return labels[slot].distance + (TIE if joint <= labels[slot].joint else -TIE)


@compiled(inline="always")
def has_parent(parents, each, v, parent):
    """Return whether any label of node v has this parent."""
    is_parent = False
    for label in range(v * each, v * each + each):
        is_parent |= parents[label] == parent
    return is_parent


@compiled(inline="always")
def bucket_of(head, scale, distance):
    """Return the bucket of a distance. Bounds are not at whole cells, where distances tie."""
    return min(int(distance * scale + 0.3), len(head) - 1)


@compiled(inline="always")
def join(head, labels, bucket, label, distance=BEFORE_ALL):
    """Insert a label that is in no bucket, before the first one that is at least as far."""
    before, after = ~bucket, head[bucket]
    while after != END and labels[after].distance < distance:
        before, after = after, labels[after].after
    labels[label].after, labels[label].before = after, before
    if before >= 0:
        labels[before].after = label
    else:
        head[bucket] = label
    if after != END:
        labels[after].before = label


@compiled(inline="always")
def sort(head, labels, bucket):
    """Sort the labels of a bucket by distance."""
    label, head[bucket] = head[bucket], END
    while label != END:
        follower = labels[label].after
        join(head, labels, bucket, label, labels[label].distance)
        label = follower


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


@compiled(inline="always")
def settle_equals(head, labels, bucket):
    """Settle the nearest labels of a sorted bucket; return the first, the next is `before` it."""
    label, limit = END, labels[head[bucket]].distance + TIE
    while head[bucket] != END and labels[head[bucket]].distance <= limit:
        follower, label = label, head[bucket]
        leave(head, labels, label)
        labels[label].after, labels[label].before = SETTLED, follower
    return label


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
