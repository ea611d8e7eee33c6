"""Solution of exercise 2."""

import numpy as np


def distance_to_segment(points, start, end):
    """Return the distance of each point to a segment, shape (n,)."""
    along = end - start
    share = (points - start) @ along / max(along @ along, 1e-12)
    nearest = start + np.clip(share, 0, 1)[:, None] * along
    return np.linalg.norm(points - nearest, axis=1)


def straight_distances(points, starts, ends, joint, count):
    """Return the distance of each point to the nearest bone of each joint, shape (n, count)."""
    distances = np.full((len(points), count), np.inf)
    for start, end, j in zip(starts, ends, joint, strict=True):
        distances[:, j] = np.minimum(distances[:, j], distance_to_segment(points, start, end))
    return distances


def falloff(distances, power):
    """Return weights (n, j) proportional to 1 / distance ** power, whose rows sum to one."""
    weights = 1 / np.maximum(distances, 0.001) ** power
    return weights / weights.sum(axis=1, keepdims=True)
