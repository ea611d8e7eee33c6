"""The connected components of a mesh, and which bones lie inside each of them."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ...geodesics import Bones
from ...geometry.sorting import sort_by_group
from ...graph.rays import column_span, height_between
from ...runtime.compiled import compiled, no_refcount
from ...runtime.threads import in_threads

POINTS = 9
"""Samples along each bone."""
FACE_CELLS = 64
"""Along each side of the grid that sorts the samples, so that a face visits those under it only."""
MAX_RIGID_SIZE = 0.25
"""Maximum size of rigid accessories and components of one joint, as part of the longest side."""
INSIDE_SHARE = 0.5
"""A point is inside a component if this part of six rays from it leave the component."""


def longest_sides(points: NDArray[np.float64], component: NDArray[np.int32]) -> NDArray[np.float64]:
    """Measure the longest side of each component, shape (components,), from points (k, 3)."""
    low = np.full((int(component.max()) + 1, 3), np.inf)
    high = -low
    np.minimum.at(low, component, points)
    np.maximum.at(high, component, points)
    return (high - low).max(axis=1)


def bone_containment(
    points: NDArray[np.float64],
    faces: NDArray[np.int32],
    component: NDArray[np.int32],
    bones: Bones,
) -> NDArray[np.float64]:
    """Measure which part of each bone lies inside each component.

    Shapes: points (k, 3), faces (m, 3), component (k,); returns (components, b).
    """
    along = (np.arange(POINTS) + 0.5) / POINTS
    samples = bones.start[:, None] + along[:, None] * (bones.end - bones.start)[:, None]
    samples = samples.reshape(-1, 3)
    count = int(component.max()) + 1
    of_face = component[faces[:, 0]]

    def along_axis(axis: int) -> tuple[NDArray, NDArray, NDArray]:
        turn = [(axis + 1) % 3, (axis + 2) % 3, axis]
        turned = np.ascontiguousarray(points[:, turn]), np.ascontiguousarray(samples[:, turn])
        face, sample, sign = _intersect(*turned, faces)
        return of_face[face], sample, sign

    hits = in_threads(along_axis, range(3))
    which, sample, sign = (np.concatenate(parts) for parts in zip(*hits, strict=True))
    key, number = np.unique(which.astype(np.int64) * len(samples) + sample, return_inverse=True)
    # Each hit belongs to the ray up or to the ray down, one of six.
    inside = np.bincount(number, sign / 6, minlength=len(key)) > INSIDE_SHARE - 1e-9
    containment = np.zeros((count, len(bones.joint)))
    inside_of, bone = key[inside] // len(samples), key[inside] % len(samples) // POINTS
    np.add.at(containment, (inside_of, bone), 1 / POINTS)
    return containment


def _intersect(
    points: NDArray[np.float64], samples: NDArray[np.float64], faces: NDArray[np.int32]
) -> tuple[NDArray[np.int64], NDArray[np.int64], NDArray[np.int8]]:
    """Intersect all lines through samples along the third axis with the faces.

    Returns the face, the sample, and +1 where a ray from the sample leaves through the face,
    -1 where it enters.
    """
    cell = np.clip((samples[:, :2] * FACE_CELLS).astype(np.int64), 0, FACE_CELLS - 1)
    column = cell[:, 0] * FACE_CELLS + cell[:, 1]
    start, order = sort_by_group(column, FACE_CELLS * FACE_CELLS)
    samples = samples[order]
    room = 8 * len(samples)
    while True:
        face, sample = np.empty((2, room), np.int64)
        sign = np.empty(room, np.int8)
        count = _list_hits(points, faces, samples, start, face, sample, sign)
        if count <= room:
            return face[:count], order[sample[:count]], sign[:count]
        room = count


@no_refcount
def _list_hits(points, faces, samples, start, face, sample, sign):
    """Return the number of ray hits, even if the arrays hold fewer.

    Samples in column i * CELLS + j of the grid are those from start[i * CELLS + j] on.
    """
    count = 0
    for f in range(len(faces)):
        a, b, c = faces[f, 0], faces[f, 1], faces[f, 2]
        low_u = min(points[a, 0], points[b, 0], points[c, 0])
        high_u = max(points[a, 0], points[b, 0], points[c, 0])
        low_v = min(points[a, 1], points[b, 1], points[c, 1])
        high_v = max(points[a, 1], points[b, 1], points[c, 1])
        for i in range(_cell(low_u), _cell(high_u) + 1):
            first, last = i * FACE_CELLS + _cell(low_v), i * FACE_CELLS + _cell(high_v)
            for s in range(start[first], start[last + 1]):
                u, v = samples[s, 0], samples[s, 1]
                if not (low_u <= u < high_u and low_v <= v <= high_v):
                    continue
                v0, height0, v1, height1, side = column_span(points, faces, f, u)
                if not v0 <= v < v1:
                    continue
                if count < len(face):
                    is_ahead = height_between(v0, height0, v1, height1, v) > samples[s, 2]
                    face[count], sample[count] = f, s
                    sign[count] = side if is_ahead else -side
                count += 1
    return count


@compiled(inline="always")
def _cell(u):
    return min(max(int(u * FACE_CELLS), 0), FACE_CELLS - 1)
