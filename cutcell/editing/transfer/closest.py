"""Closest points of a surface."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from ...geometry.segments import closest_on_segment
from ...geometry.welded import WeldedMesh

TRIED = 6
"""Samples whose faces are searched for the closest point."""
MAX_DIVISIONS = 64
"""Parts of a face's side between samples, at most."""


class Points(NamedTuple):
    """Points of a surface that are near to others.

    Parameters
    ----------
    point : array, shape (c,)
        Which of the others each is for.
    face : array, shape (c,)
    share : array, shape (c, 3), float64
        Barycentric coordinates in the face.
    distance : array, shape (c,), float64
    """

    point: NDArray[np.intp]
    face: NDArray[np.intp]
    share: NDArray[np.float64]
    distance: NDArray[np.float64]

    def subset(self, which: NDArray) -> Points:
        """Return some of them."""
        return Points(*(values[which] for values in self))

    def first(self) -> NDArray[np.intp]:
        """Return the first one for each point, where they are sorted by point."""
        return np.flatnonzero(np.append(True, np.diff(self.point) > 0)[: len(self.point)])


class Surface:
    """Some faces of a mesh, sampled so that closest points are searched on few of them.

    Parameters
    ----------
    mesh : WeldedMesh
    faces : array, shape (f, 3)
    spacing : float
        Largest distance from a point of a face to a sample of it, about.
    """

    def __init__(self, mesh: WeldedMesh, faces: NDArray[np.int32], spacing: float) -> None:
        self.mesh, self.faces, self.spacing = mesh, faces, spacing
        self.corners = mesh.points[faces]
        longest = np.linalg.norm(self.corners - np.roll(self.corners, 1, axis=1), axis=2).max(
            axis=1
        )
        divisions = np.clip(np.ceil(longest / spacing), 1, MAX_DIVISIONS).astype(int)
        face, places = [], []
        for n in np.unique(divisions):  # the centres of n² parts of each face
            which = np.flatnonzero(divisions == n)
            i, j = (axis.ravel() for axis in np.mgrid[:n, :n])
            upright, turned = i + j < n, i + j < n - 1
            i, j = (
                np.concatenate([axis[upright] + 1 / 3, axis[turned] + 2 / 3]) / n for axis in (i, j)
            )
            share = np.stack([1 - i - j, i, j], axis=1)
            face.append(np.repeat(which, len(share)))
            places.append((share @ self.corners[which]).reshape(-1, 3))
        # A vertex of large faces among many small ones is closest to itself.
        vertex, corner = np.unique(faces, return_index=True)
        face.append(corner // 3)
        places.append(mesh.points[vertex])
        self.sample_face, self.samples = np.concatenate(face), np.concatenate(places)

    def at(self, rows: NDArray[np.float64], points: Points) -> NDArray[np.float64]:
        """Interpolate rows (k, ...) of the mesh's vertices at some points of the surface."""
        return np.einsum("pc,pc...->p...", points.share, rows[self.faces[points.face]])

    def nearest(
        self,
        points: NDArray[np.float64],
        samples: NDArray[np.intp] | slice = slice(None),
        radius: float = np.inf,
    ) -> Points:
        """Return the closest point on the faces of some samples, for each point that is near.

        Another point may be closer by a part of the spacing where many small faces are near.

        Shapes: points (p, 3), samples (s,) ascending; radius or (p,).
        """
        face, places = self.sample_face[samples], self.samples[samples]
        within = radius + self.spacing
        low, high = places.min(axis=0) - within, places.max(axis=0) + within
        near = np.flatnonzero(((points >= low) & (points <= high)).all(axis=1))
        count = min(TRIED, len(places))
        query = cKDTree(places).query(points[near], count, distance_upper_bound=within)
        away, sample = (values.reshape(len(near), count) for values in query)
        row, rank = np.nonzero(np.isfinite(away))
        point, face = near[row], face[sample[row, rank]]
        share = barycentric(points[point], self.corners[face])
        on_face = np.einsum("pc,pcx->px", share, self.corners[face])
        distance = np.linalg.norm(on_face - points[point], axis=1)
        every = Points(point, face, share, distance)
        every = every.subset(np.lexsort((distance, point)))
        return every.subset(every.first())


def barycentric(points: NDArray[np.float64], corners: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return where on triangles (p, 3, 3) the closest points to points (p, 3) lie, (p, 3)."""
    first, second, third = corners.swapaxes(0, 1)
    normal = np.cross(second - first, third - first)
    squared = np.maximum(np.einsum("px,px->p", normal, normal), 1e-300)[:, None]
    share = np.stack(
        [
            np.einsum("px,px->p", np.cross(b - a, points - a), normal)
            for a, b in ((second, third), (third, first), (first, second))
        ],
        axis=1,
    )
    share /= squared
    share[:, 0] = 1 - share[:, 1] - share[:, 2]
    outside = np.flatnonzero(~(share >= 0).all(axis=1))
    best = np.full(len(outside), np.inf)
    for edge in range(3):
        start, end = corners[outside, edge], corners[outside, (edge + 1) % 3]
        place, fraction = closest_on_segment(points[outside], start, end)
        away = np.linalg.norm(place - points[outside], axis=1)
        nearer, best = away < best, np.minimum(away, best)
        on_edge = np.zeros((len(outside), 3))
        on_edge[:, edge], on_edge[:, (edge + 1) % 3] = 1 - fraction, fraction
        share[outside[nearer]] = on_edge[nearer]
    return share
