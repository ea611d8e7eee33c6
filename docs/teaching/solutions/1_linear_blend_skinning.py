"""Solution of exercise 1."""

import numpy as np


def rotation_about(point, degrees):
    """Return the 4 x 4 matrix that rotates about the z axis through a point."""
    angle = np.radians(degrees)
    matrix = np.eye(4)
    matrix[:2, :2] = [[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]]
    matrix[:3, 3] = point - matrix[:3, :3] @ point
    return matrix


def skin(vertices, weights, matrices):
    """Return the posed vertices, shape (n, 3)."""
    columns = np.hstack([vertices, np.ones((len(vertices), 1))])
    moved = np.einsum("jab,nb->nja", matrices, columns)[..., :3]
    return (weights[..., None] * moved).sum(axis=1)
