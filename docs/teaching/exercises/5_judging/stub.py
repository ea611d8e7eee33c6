"""Exercise 5: how good are weights? L1 against motion.

walker.npz contains an artist's weights and three others, A, B and C. Two measures compare weights
with the artist's: L1 compares the numbers, and the motion error compares where the vertices go.
Fill in the functions, and copy `skin` from exercise 1.

Question 1: By L1 the three are alike. In which order does the motion error put them?
Question 2: The median error of A is tiny. What ruins it?
Question 3: Name a motion in which A and the artist hardly differ. What follows for comparisons?
"""

import numpy as np


def skin(vertices, weights, matrices):
    """Return the posed vertices, shape (n, 3): your function of exercise 1."""
    raise NotImplementedError


def l1(weights, reference):
    """Return the mean over vertices of the summed absolute differences of weights, from 0 to 2.

    Parameters
    ----------
    weights, reference : array, shape (n, j)
    """
    raise NotImplementedError


def motion_errors(vertices, weights, reference, motion):
    """Return how far each vertex is from its place by the reference, shape (f, n).

    Parameters
    ----------
    vertices : array, shape (n, 3)
    weights, reference : array, shape (n, j)
    motion : array, shape (f, j, 4, 4)
        The matrices of the joints in each frame.
    """
    raise NotImplementedError


def root_mean_square(errors):
    """Return the square root of the mean of the squares of all errors.

    Parameters
    ----------
    errors : array
        Of any shape.
    """
    raise NotImplementedError
