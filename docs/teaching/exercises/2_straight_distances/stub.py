"""Exercise 2: weights from straight distances.

A bone is a segment from a joint to its child, and a joint may have several bones. The nearer a
joint's bones, the larger its weight. Fill in the three functions.

Question 1: Which vertices outside the arm follow the hand in your picture, and why?
Question 2: Does a larger power prevent this? Change POWER in draw.py. What else changes?
"""

import numpy as np


def distance_to_segment(points, start, end):
    """Return the distance of each point to a segment, shape (n,).

    Parameters
    ----------
    points : array, shape (n, 3)
    start, end : array, shape (3,)
        They may be equal.
    """
    raise NotImplementedError


def straight_distances(points, starts, ends, joint, count):
    """Return the distance of each point to the nearest bone of each joint, shape (n, count).

    Parameters
    ----------
    points : array, shape (n, 3)
    starts, ends : array, shape (b, 3)
        The ends of the bones.
    joint : array, shape (b,)
        The joint of each bone.
    count : int
        Number of joints. A joint without bones is infinitely far.
    """
    raise NotImplementedError


def falloff(distances, power):
    """Return weights (n, j) proportional to 1 / distance ** power, whose rows sum to one.

    Parameters
    ----------
    distances : array, shape (n, j)
        Count distances below 0.001 as 0.001. Infinite ones give no weight.
    power : float
    """
    raise NotImplementedError
