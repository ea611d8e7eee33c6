"""Labels that wait for their turn, sorted into buckets by distance (Dial 1969).

A bucket is a doubly linked list through the labels themselves: joining and leaving take no
search, and no memory is needed beyond two integers a label. Buckets are served in order and
are so narrow that the order within one does not matter.
"""

import numpy as np
from numba import njit

END, LOOSE, SETTLED = -1, -2, -3
"""What `after` holds instead of another label: last of its bucket, in no bucket, or done."""


def bucket_queue(labels, buckets, scale):
    """Make an empty queue.

    Parameters
    ----------
    labels : int
        How many labels there are.
    buckets : int
        The last one holds everything that lies beyond, until `move_on`.
    scale : float
        Buckets per unit of distance.

    Returns
    -------
    scale : float
    head : array, shape (buckets,), int32
        The first label of each bucket.
    after, before : arrays, shape (labels,), int32
        The next label of the same bucket; the one before, or ~bucket for its first.
    """
    head = np.full(buckets, END, np.int32)
    after = np.full(labels, LOOSE, np.int32)
    return float(scale), head, after, np.empty(labels, np.int32)


@njit(cache=True, inline="always")
def bucket_of(head, scale, distance):
    """Return the bucket of a distance."""
    return min(int(distance * scale), len(head) - 1)


@njit(cache=True, inline="always")
def join(head, after, before, bucket, label):
    """Put a label that is in no bucket into one."""
    follower = head[bucket]
    head[bucket], after[label], before[label] = label, follower, ~bucket
    if follower != END:
        before[follower] = label


@njit(cache=True, inline="always")
def leave(head, after, before, label):
    """Take a label out of its bucket, if it is in one."""
    if after[label] < END:
        return
    if before[label] >= 0:
        after[before[label]] = after[label]
    else:
        head[~before[label]] = after[label]
    if after[label] != END:
        before[after[label]] = before[label]
    after[label] = LOOSE


@njit(cache=True)
def move_on(queue, distance):
    """Spread what lies beyond the last bucket over all; return the distance they begin at."""
    scale, head, after, before = queue
    label, origin = head[-1], np.inf
    while label != END:
        origin = min(origin, distance[label])
        label = after[label]
    label, head[-1] = head[-1], END
    while label != END:
        follower = after[label]
        join(head, after, before, bucket_of(head, scale, distance[label] - origin), label)
        label = follower
    return origin
