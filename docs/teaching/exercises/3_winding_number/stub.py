"""Exercise 3: a winding number in 2D.

An outline is a set of directed segments, in any order. Its winding number at a point is the sum of
the signed angles under which the point sees the segments, over 360 degrees. A closed outline that
runs counter-clockwise has 1 inside and 0 outside. Fill in both functions.

Question 1: What is the number inside a closed outline that runs clockwise, and in a hole?
Question 2: In your picture of the torn outline, where is the number 0.3, and what does 0.3 mean?
Question 3: Why is one half a good threshold for "inside"?
"""

import numpy as np


def winding_number(segments, points):
    """Return the winding number at each point, shape (n,).

    Parameters
    ----------
    segments : array, shape (m, 2, 2)
        Start and end of each segment, each with x and y.
    points : array, shape (n, 2)
        None of them is on a segment.
    """
    raise NotImplementedError


def signed_crossings(segments, point):
    """Return the sum over all crossings of the ray from a point in direction +x, an int.

    A segment that crosses the ray upwards counts +1, one that crosses it downwards counts -1. For
    a closed outline this equals the winding number. The ray may run through ends of segments:
    count an end on the ray as above it.

    Parameters
    ----------
    segments : array, shape (m, 2, 2)
    point : array, shape (2,)
    """
    raise NotImplementedError
