"""Solution of exercise 3."""

import numpy as np


def winding_number(segments, points):
    """Return the winding number at each point, shape (n,)."""
    total = np.zeros(len(points))
    for start, end in segments:
        a, b = start - points, end - points
        cross = a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]
        total += np.arctan2(cross, (a * b).sum(axis=1))
    return total / (2 * np.pi)


def signed_crossings(segments, point):
    """Return the sum over all crossings of the ray from a point in direction +x, an int."""
    count = 0
    for (ax, ay), (bx, by) in segments - point:
        if (ay >= 0) == (by >= 0):
            continue
        if ax + (bx - ax) * ay / (ay - by) > 0:
            count += 1 if by > ay else -1
    return count
