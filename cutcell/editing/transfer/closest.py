"""Closest points of a surface whose normals fit."""

from __future__ import annotations

from functools import cached_property
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from ...errors import WeightsError
from ...geometry.segments import closest_on_segment
from ...geometry.triangles import normals as face_normals
from ...geometry.vectors import TIE
from ...geometry.welded import WeldedMesh

TRIED = 6
"""Samples of a patch whose faces are searched for the closest point."""
MAX_DIVISIONS = 64
"""Parts of a face's side between samples, at most."""


class Candidates(NamedTuple):
    """Closest points on patches of a surface, sorted by point, the nearest first.

    Parameters
    ----------
    point : array, shape (c,)
        Which of the points it is for.
    face : array, shape (c,)
    share : array, shape (c, 3), float64
        Barycentric coordinates in the face.
    distance : array, shape (c,), float64
    """

    point: NDArray[np.intp]
    face: NDArray[np.intp]
    share: NDArray[np.float64]
    distance: NDArray[np.float64]

    def subset(self, which: NDArray) -> Candidates:
        """Return some of them."""
        return Candidates(*(values[which] for values in self))


class Surface:
    """A surface in patches, sampled so that closest points are found among few faces.

    Parameters
    ----------
    mesh : WeldedMesh
    weighted : array, shape (k,), bool
        Faces that have another corner are left out.
    patch : array, shape (k,)
        A number for each welded vertex. Each patch has a closest point, and within it each of the
        six directions that faces turn to.
    spacing : float
        Largest distance from a point of a face to a sample of it, about.
    """

    def __init__(
        self,
        mesh: WeldedMesh,
        weighted: NDArray[np.bool_],
        patch: NDArray[np.intp],
        spacing: float,
    ) -> None:
        self.mesh = mesh
        self.faces = mesh.faces[mesh.is_whole & weighted[mesh.faces].all(axis=1)]
        if not len(self.faces):
            raise WeightsError(
                "no triangle of the source has weights at all corners; bind it first"
            )
        self.corners = mesh.points[self.faces]
        normal = face_normals(self.corners)
        axis = np.abs(normal).argmax(axis=1)
        side = 2 * axis + (np.take_along_axis(normal, axis[:, None], 1)[:, 0] < 0)
        self.patch = 6 * patch[self.faces[:, 0]] + side
        self.spacing = spacing

    def at(self, rows: NDArray[np.float64], points: Candidates) -> NDArray[np.float64]:
        """Interpolate rows (k, ...) of the welded vertices at some points of the surface."""
        return np.einsum("pc,pc...->p...", points.share, rows[self.faces[points.face]])

    @cached_property
    def samples(self) -> tuple[NDArray[np.intp], NDArray[np.float64]]:
        """The face of each sample, (s,), and its position, (s, 3): centres of parts of the face."""
        longest = np.linalg.norm(self.corners - np.roll(self.corners, 1, axis=1), axis=2).max(
            axis=1
        )
        divisions = np.clip(np.ceil(longest / self.spacing), 1, MAX_DIVISIONS).astype(int)
        face, places = [], []
        for n in np.unique(divisions):
            which = np.flatnonzero(divisions == n)
            i, j = (axis.ravel() for axis in np.mgrid[:n, :n])
            upright, turned = i + j < n, i + j < n - 1
            i, j = (
                np.concatenate([axis[upright] + 1 / 3, axis[turned] + 2 / 3]) / n for axis in (i, j)
            )
            share = np.stack([1 - i - j, i, j], axis=1)
            face.append(np.repeat(which, len(share)))
            places.append((share @ self.corners[which]).reshape(-1, 3))
        return np.concatenate(face), np.concatenate(places)

    def candidates(
        self,
        points: NDArray[np.float64],
        normals: NDArray[np.float64],
        radius: float,
        cosine: float,
        flipped: bool,
    ) -> Candidates:
        """Return the closest point of each patch within a radius whose normal fits, if any.

        A normal fits if its angle to the point's own has at least this cosine; either sign counts
        if `flipped`. A point without a normal fits everywhere.

        Shapes: points, normals (p, 3).
        """
        face, places = self.samples
        order = np.argsort(self.patch[face], kind="stable")
        ends = np.append(np.flatnonzero(np.diff(self.patch[face[order]])) + 1, len(order))
        results, begin = [], 0
        for end in ends:
            chosen, begin = order[begin:end], end
            low, high = places[chosen].min(axis=0), places[chosen].max(axis=0)
            within = radius + self.spacing
            near = np.flatnonzero(
                ((points >= low - within) & (points <= high + within)).all(axis=1)
            )
            count = min(TRIED, len(chosen))
            away, sample = cKDTree(places[chosen]).query(
                points[near], count, distance_upper_bound=within
            )
            row, rank = np.nonzero(np.isfinite(away.reshape(len(near), count)))
            tried = chosen[sample.reshape(len(near), count)[row, rank]]
            results.append(self._closest(points, near[row], face[tried]))
        every = Candidates(*map(np.concatenate, zip(*results, strict=True)))
        fits = self._fits(every, normals, cosine, flipped) & (every.distance <= radius)
        every = every.subset(fits)
        by_patch = np.lexsort((every.distance, self.patch[every.face], every.point))
        every = every.subset(by_patch)
        key = every.point * (int(self.patch.max()) + 1) + self.patch[every.face]
        every = every.subset(np.append(True, np.diff(key) > 0)[: len(key)])
        return every.subset(np.lexsort((every.distance, every.point)))

    def nearest(self, points: NDArray[np.float64]) -> Candidates:
        """Return the closest point of the surface, whatever its distance and normal."""
        face, places = self.samples
        count = min(TRIED, len(places))
        tried = cKDTree(places).query(points, count)[1].reshape(-1)
        every = self._closest(points, np.repeat(np.arange(len(points)), count), face[tried])
        return every.subset(
            np.arange(len(points)) * count + every.distance.reshape(-1, count).argmin(axis=1)
        )

    def _closest(
        self, points: NDArray[np.float64], point: NDArray[np.intp], face: NDArray[np.intp]
    ) -> Candidates:
        share = barycentric(points[point], self.corners[face])
        on_face = np.einsum("pc,pcx->px", share, self.corners[face])
        return Candidates(point, face, share, np.linalg.norm(on_face - points[point], axis=1))

    def _fits(
        self, points: Candidates, normals: NDArray[np.float64], cosine: float, flipped: bool
    ) -> NDArray[np.bool_]:
        own = normals[points.point]
        other = np.einsum("pc,pcx->px", points.share, self.mesh.normals[self.faces[points.face]])
        size = np.linalg.norm(own, axis=1) * np.linalg.norm(other, axis=1)
        product = np.einsum("px,px->p", own, other)
        product = np.abs(product) if flipped else product
        return (size == 0) | (product >= cosine * size - TIE)


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
