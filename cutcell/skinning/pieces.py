"""The pieces that a mesh falls into, and the bones that each holds."""

from __future__ import annotations

import numpy as np
from numba import njit
from numpy.typing import NDArray

from ..compiled import lean
from ..geodesics import Bones
from ..threads import in_threads
from ..unions import join, numbered

POINTS = 9
"""Looked at along each bone."""
STRETCHES = 256
"""Of the unit side, to find the samples that a face may lie above."""
INSIDE = 0.5
"""A point is inside a piece if this part of six rays from it leave the piece."""


def find_pieces(faces: NDArray[np.int32], count: int) -> NDArray[np.int32]:
    """Return for each of `count` places the number of its piece: what edges join is one."""
    return _pieces(faces, count)


@njit(cache=True, nogil=True)
def _pieces(faces, count):
    first = np.arange(count)
    for f in range(len(faces)):
        low = join(first, faces[f, 0], faces[f, 1])
        join(first, low, faces[f, 2])
    return numbered(first)[0]


def bones_held(
    points: NDArray[np.float64], faces: NDArray[np.int32], piece: NDArray[np.int32], bones: Bones
) -> NDArray[np.float64]:
    """Measure which part of each bone lies inside each piece, shape (pieces, b).

    Parameters
    ----------
    points : array, shape (k, 3)
    faces : array, shape (m, 3)
    piece : array, shape (k,)
        Of each place; see `find_pieces`.
    bones : Bones
    """
    along = (np.arange(POINTS) + 0.5) / POINTS
    samples = bones.start[:, None] + along[:, None] * (bones.end - bones.start)[:, None]
    samples = samples.reshape(-1, 3)
    count = int(piece.max()) + 1
    of_face = piece[faces[:, 0]]

    def along_axis(axis: int) -> tuple[NDArray, NDArray, NDArray]:
        u, v = (axis + 1) % 3, (axis + 2) % 3
        order = np.argsort(samples[:, u], kind="stable")
        turned = np.ascontiguousarray(samples[order][:, [u, v, axis]])
        face, place, sign = _crossed(np.ascontiguousarray(points[:, [u, v, axis]]), faces, turned)
        return of_face[face], order[place], sign

    hits = in_threads(along_axis, range(3))
    which, sample, sign = (np.concatenate(parts) for parts in zip(*hits, strict=True))
    key, place = np.unique(which.astype(np.int64) * len(samples) + sample, return_inverse=True)
    # Each hit counts for the ray up that meets it, or for the ray down: +-1 of six.
    inside = np.bincount(place, sign / 6, minlength=len(key)) > INSIDE - 1e-9
    held = np.zeros((count, len(bones.joint)))
    hit_piece, hit_bone = key[inside] // len(samples), key[inside] % len(samples) // POINTS
    np.add.at(held, (hit_piece, hit_bone), 1 / POINTS)
    return held


def _crossed(
    points: NDArray[np.float64], faces: NDArray[np.int32], samples: NDArray[np.float64]
) -> tuple[NDArray[np.int64], NDArray[np.int64], NDArray[np.int8]]:
    """List the crossings of all lines through samples, ascending in u, along the third axis.

    Returns the face, the sample, and +1 where a ray from the sample leaves through the face,
    -1 where it enters.
    """
    stretch = np.clip((samples[:, 0] * STRETCHES).astype(np.int64), 0, STRETCHES - 1)
    start = np.searchsorted(stretch, np.arange(STRETCHES + 1))
    room = 8 * len(samples)
    while True:
        face, sample, sign = (
            np.empty(room, np.int64),
            np.empty(room, np.int64),
            np.empty(room, np.int8),
        )
        count = _list_crossings(points, faces, samples, start, face, sample, sign)
        if count <= room:
            return face[:count], sample[:count], sign[:count]
        room = count


@lean
def _list_crossings(points, faces, samples, start, face, sample, sign):
    """Return how many crossings there are, also beyond the room for them.

    Samples in stretch s of the unit side are those from start[s] on.
    """
    count = 0
    for f in range(len(faces)):
        a, b, c = faces[f, 0], faces[f, 1], faces[f, 2]
        low = min(points[a, 0], points[b, 0], points[c, 0])
        high = max(points[a, 0], points[b, 0], points[c, 0])
        nearest = min(points[a, 1], points[b, 1], points[c, 1])
        farthest = max(points[a, 1], points[b, 1], points[c, 1])
        for s in range(start[_stretch(low)], start[_stretch(high) + 1]):
            p, q = samples[s, 0], samples[s, 1]
            if not (low <= p < high and nearest <= q <= farthest):
                continue
            # On the line u = const, how many edges of the face lie on the side of larger v.
            above, turn = 0, 0
            for k in range(3):
                i, j = faces[f, k], faces[f, (k + 1) % 3]
                up = 1 if (points[j, 0] > p) and (points[i, 0] <= p) else 0
                down = 1 if (points[i, 0] > p) and (points[j, 0] <= p) else 0
                if up + down == 0:
                    continue
                if down:  # one order of the ends, so that both faces of an edge agree
                    i, j = j, i
                share = (p - points[i, 0]) / (points[j, 0] - points[i, 0])
                if points[i, 1] + share * (points[j, 1] - points[i, 1]) > q:
                    above += 1
                    turn += up - down
            if above != 1:
                continue
            if count < len(face):
                height = _height(points[a], points[b], points[c], p, q)
                # turn is +1 where the face is seen turning clockwise from above: facing down
                facing = -turn
                face[count] = f
                sample[count] = s
                sign[count] = facing if height > samples[s, 2] else -facing
            count += 1
    return count


@njit(cache=True, inline="always")
def _stretch(u):
    return min(max(int(u * STRETCHES), 0), STRETCHES - 1)


@lean
def _height(a, b, c, u, v):
    """Return where the plane through three points is over (u, v)."""
    x1, y1, z1 = b[0] - a[0], b[1] - a[1], b[2] - a[2]
    x2, y2, z2 = c[0] - a[0], c[1] - a[1], c[2] - a[2]
    cross = x1 * y2 - x2 * y1
    if cross == 0:
        return a[2]
    s = ((u - a[0]) * y2 - (v - a[1]) * x2) / cross
    t = ((v - a[1]) * x1 - (u - a[0]) * y1) / cross
    return a[2] + s * z1 + t * z2
