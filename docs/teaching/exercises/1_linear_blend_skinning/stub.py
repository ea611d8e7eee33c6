"""Exercise 1: linear blend skinning.

A character has rest vertices, weights, and a 4 x 4 matrix for each joint that moves rest points to
posed points. Fill in both functions.

Question 1: What happens to a vertex whose weights sum to 0.9?
Question 2: Why does the bent elbow in your picture become thin?
"""

import numpy as np


def rotation_about(point, degrees):
    """Return the 4 x 4 matrix that rotates about the z axis through a point, counter-clockwise.

    Parameters
    ----------
    point : array, shape (3,)
        A point of the axis, which therefore stays where it is.
    degrees : float
    """
    raise NotImplementedError


def skin(vertices, weights, matrices):
    """Return the posed vertices, shape (n, 3).

    A posed vertex is the weighted sum of the places to which the joints' matrices move it.

    Parameters
    ----------
    vertices : array, shape (n, 3)
    weights : array, shape (n, j)
    matrices : array, shape (j, 4, 4)
        They multiply columns (x, y, z, 1) from the left.
    """
    raise NotImplementedError
