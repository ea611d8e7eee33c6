"""A bucket queue of labels, by distance (Dial 1969).

A bucket is a doubly linked list through the labels themselves: a label is inserted and removed
without a search, and with two integers of memory. Buckets are served in order, and are so narrow
that the order within one does not matter.

The first label of each bucket is in an array `head`, shape (buckets,), int32; `scale` is the
number of buckets a unit of distance. The last bucket holds everything beyond, until
`move_on`. A label's field `after` is the next of the same bucket, `before` the one before, or
~bucket for its first.
"""

import numpy as np

from ...runtime.compiled import compiled

END, LOOSE, SETTLED = -1, -2, -3
"""Values of `after` other than a label: last of its bucket, in no bucket, settled."""


@compiled(inline="always")
def bucket_of(head, scale, distance):
    """Return the bucket of a distance."""
    return min(int(distance * scale), len(head) - 1)


@compiled(inline="always")
def join(head, labels, bucket, label):
    """Insert a label that is in no bucket."""
    follower = head[bucket]
    head[bucket], labels[label].after, labels[label].before = label, follower, ~bucket
    if follower != END:
        labels[follower].before = label


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
