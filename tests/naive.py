"""Slow oracles, written to be read: exact fractions, plain sums, one loop after the other."""

import heapq
from fractions import Fraction
from itertools import pairwise

import numpy as np

from cutcell.pose import linear_blend_skinning, rotate_joint

PLANE = {0: (1, 2), 1: (0, 2), 2: (0, 1)}


def orientation(a, b, p):
    """Sign of the turn a -> b -> p in the plane; p is moved by e in v and by e^2 in u."""
    turn = (b[0] - a[0]) * (p[1] - a[1]) - (b[1] - a[1]) * (p[0] - a[0])
    for term in (turn, b[0] - a[0], a[1] - b[1]):
        if term != 0:
            return 1 if term > 0 else -1
    return 0


def rays(vertices, faces, resolution, axis):
    """All crossings (i, j, position, sign, triangle) along one axis, in exact fractions."""
    u, v = PLANE[axis]
    exact = [[Fraction(float(x)) for x in p] for p in vertices]
    result = []
    for t, face in enumerate(faces):
        corners = [(exact[k][u], exact[k][v], exact[k][axis]) for k in face]
        a, b, c = corners
        area = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
        if area == 0:
            continue
        for i in range(resolution):
            # The lattice's own coordinates are floating-point numbers.
            pu = Fraction((i + 0.5) / resolution)
            if not min(a[0], b[0], c[0]) <= pu <= max(a[0], b[0], c[0]):
                continue
            for j in range(resolution):
                p = pu, Fraction((j + 0.5) / resolution)
                sides = {orientation(corners[k], corners[(k + 1) % 3], p) for k in range(3)}
                if len(sides) > 1:
                    continue
                weight = [
                    ((y[0] - x[0]) * (p[1] - x[1]) - (y[1] - x[1]) * (p[0] - x[0])) / area
                    for x, y in ((b, c), (c, a), (a, b))
                ]
                position = sum(w * q[2] for w, q in zip(weight, corners, strict=True))
                sign = sides.pop() * (-1 if axis == 1 else 1)
                result.append((i, j, float(position), sign, t))
    return sorted(result)


def winding_number(vertices, faces, points):
    """Sum of the solid angles of all triangles (van Oosterom & Strackee), over 4 pi."""
    total = np.zeros(len(points))
    for face in faces:
        p, q, r = vertices[face]
        if not np.cross(q - p, r - p).any():
            continue  # no area, and no solid angle either; arctan2(0, -1) would say pi
        a, b, c = p - points, q - points, r - points
        la, lb, lc = (np.linalg.norm(x, axis=1) for x in (a, b, c))
        numerator = np.einsum("ij,ij->i", a, np.cross(b, c))
        denominator = (
            la * lb * lc
            + np.einsum("ij,ij->i", a, b) * lc
            + np.einsum("ij,ij->i", b, c) * la
            + np.einsum("ij,ij->i", c, a) * lb
        )
        total += np.arctan2(numerator, denominator)
    return total / (2 * np.pi)


def segments(vertices, faces, resolution, tau):
    """All kept segments as ((axis, i, j, kind, place), (...)), lattice points and crossings.

    A crossing is named by its ray and its place along it, a lattice point by x, y, z.
    """
    result = []
    for axis in range(3):
        by_ray = {}
        for i, j, position, sign, _ in rays(vertices, faces, resolution, axis):
            by_ray.setdefault((i, j), []).append((position, sign))
        for i in range(resolution):
            for j in range(resolution):
                crossings = sorted(by_ray.get((i, j), []))
                stops = [(p, 0, n, s) for n, (p, s) in enumerate(crossings)]
                stops += [((k + 0.5) / resolution, 1, k, 0) for k in range(resolution)]
                stops.sort()  # a crossing comes before a lattice point at the same place
                result += _segments_of_ray(axis, i, j, stops, resolution)
    ends, middles, crossed = zip(*result, strict=True)
    inside = winding_number(vertices, faces, np.array(middles)) - crossed
    return {pair for pair, number in zip(ends, inside, strict=True) if number >= tau}


def _segments_of_ray(axis, i, j, stops, resolution):
    """List (ends, place to take the winding number at, what to count off it)."""
    result = []
    u, v = PLANE[axis]
    for n, (a, b) in enumerate(pairwise(stops)):
        middle, crossed = np.empty(3), 0
        middle[u], middle[v] = (i + 0.5) / resolution, (j + 0.5) / resolution
        middle[axis] = (a[0] + b[0]) / 2
        if a[0] == b[0]:
            # No length: take the number just before this place, and count from there.
            middle[axis] -= 1e-9
            crossed = sum(s for p, _, _, s in stops[: n + 1] if p == a[0])
        result.append(((_name(axis, i, j, a), _name(axis, i, j, b)), middle, crossed))
    return result


def _name(axis, i, j, stop):
    _, kind, place, _ = stop
    if kind == 0:
        return ("crossing", axis, i, j, place)
    u, v = PLANE[axis]
    point = [0, 0, 0]
    point[u], point[v], point[axis] = i, j, place
    return ("lattice", *point)


def shortest_paths(count, edges, lengths, sources):
    """Dijkstra's algorithm from {node: first distance}."""
    neighbours = [[] for _ in range(count)]
    for (a, b), length in zip(edges, lengths, strict=True):
        neighbours[a].append((b, length))
        neighbours[b].append((a, length))
    distance = [float("inf")] * count
    queue = [(d, node) for node, d in sources.items()]
    for d, node in queue:
        distance[node] = min(distance[node], d)
    heapq.heapify(queue)
    while queue:
        d, node = heapq.heappop(queue)
        if d > distance[node]:
            continue
        for other, length in neighbours[node]:
            if d + length < distance[other]:
                distance[other] = d + length
                heapq.heappush(queue, (d + length, other))
    return np.array(distance)


def paper_weights(distance, diagonal, alpha):
    """Equation 1 as it stands in the paper, normalised; distance is (j, n)."""
    weights = np.zeros(distance.T.shape)
    for i, j in np.ndindex(*weights.shape):
        d = distance[j, i] / diagonal
        weights[i, j] = (1 / ((1 - alpha) * d + alpha * d**2)) ** 2 if np.isfinite(d) else 0
    return weights / weights.sum(axis=1, keepdims=True)


def stretch(points, edges, weights, skeleton, degrees=30.0, factor=2.0):
    """Part of the edges' length that some joint's turn stretches or shrinks, and by which joint.

    Returns the part, and for each joint the length that its own turns stretch.
    """
    total, stretched, by_joint = 0.0, 0.0, np.zeros(len(skeleton.joints))
    posed = [
        [linear_blend_skinning(points, weights, rotate_joint(skeleton, j, axis, degrees))
         for axis in "xyz"]
        for j in range(len(skeleton.joints))
    ]  # fmt: skip
    for a, b in edges:
        length = np.linalg.norm(points[a] - points[b])
        total += length
        is_stretched = False
        for j, poses in enumerate(posed):
            lengths = [np.linalg.norm(pose[a] - pose[b]) for pose in poses]
            if any(one > factor * length or one * factor < length for one in lengths):
                by_joint[j] += length
                is_stretched = True
        stretched += length * is_stretched
    return stretched / total, by_joint
