"""Inputs of a network from a rig: points of its surface, joints, bones and a prior."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_array
from scipy.sparse.csgraph import dijkstra, shortest_path

from cutcell.errors import WeightsError
from cutcell.geometry.edges import find_edges
from cutcell.rig import Rig, Skeleton

from ..dataset.audit.points import mesh_normals
from ..metrics.deformation import longest_side

RING, NEAR = 6, 16
"""Neighbours of a point: those for the one-ring, and those for the geodesic ball."""
STORED_NEIGHBOURS = 64
"""Neighbours that are kept, so that enough are left among some of the points."""
FAR = 0.25
"""Largest distance of neighbours along the surface, relative to the longest side."""
LENGTHS = 50_000_000
"""Lengths of paths that are kept at a time, each 8 bytes."""
MAX_HOPS = 16
"""Largest number of bones counted between two joints."""


@dataclass(frozen=True, eq=False)
class Sample:
    """Inputs of a network from a rig, in longest sides, centred at the origin.

    Only joints that may carry weight are in it; the parent of each is the nearest of them above.

    Parameters
    ----------
    name : str
    points, normals : arrays, shape (p, 3), float32
        Some welded vertices, or all.
    joints, tails : arrays, shape (j, 3), float32
        The ends of each joint's bone: itself and the mean of its children. A leaf has both in one
        place.
    parents : array, shape (j,), int64
        -1 for a root.
    prior : array, shape (p, j), float32, or None
        Weights of another method; rows sum to one.
    target : array, shape (p, j), float32, or None
        The artist's weights.
    neighbours : array, shape (p, STORED_NEIGHBOURS), int64
        Other points, the nearest along the surface first; itself where there are no more.
    vertices : array, shape (p,), int64
        Which vertices of the rig the points are.
    deform : array, shape (j,), int64
        Which joints of the rig the joints are.
    """

    name: str
    points: NDArray[np.float32]
    normals: NDArray[np.float32]
    joints: NDArray[np.float32]
    tails: NDArray[np.float32]
    parents: NDArray[np.int64]
    prior: NDArray[np.float32] | None
    target: NDArray[np.float32] | None
    neighbours: NDArray[np.int64]
    vertices: NDArray[np.int64]
    deform: NDArray[np.int64]

    @property
    def ring(self) -> NDArray[np.int64]:
        """The nearest points along the surface, (p, RING), in place of a mesh's one-ring."""
        return self.neighbours[:, :RING]

    @property
    def near(self) -> NDArray[np.int64]:
        """More of them, (p, NEAR), in place of RigNet's geodesic ball."""
        return self.neighbours[:, :NEAR]

    def part(self, chosen: NDArray) -> Sample:
        """Return the sample of some of its points only."""
        place = np.full(len(self.points), -1)
        place[chosen] = np.arange(len(chosen))
        neighbours = place[self.neighbours[chosen]]
        neighbours[neighbours == np.arange(len(chosen))[:, None]] = -1
        order = np.argsort(neighbours < 0, axis=1, kind="stable")
        neighbours = np.take_along_axis(neighbours, order, axis=1)
        return replace(
            self,
            points=self.points[chosen],
            normals=self.normals[chosen],
            prior=None if self.prior is None else self.prior[chosen],
            target=None if self.target is None else self.target[chosen],
            neighbours=np.where(neighbours >= 0, neighbours, np.arange(len(chosen))[:, None]),
            vertices=self.vertices[chosen],
        )

    def parts(self, count: int, rng: np.random.Generator) -> list[NDArray[np.int64]]:
        """Split the points at random into parts of about `count`; 0 for one part."""
        order = rng.permutation(len(self.points))
        return np.array_split(order, max(1, round(len(order) / count)) if count else 1)

    def with_prior(self, weights: NDArray | None) -> Sample:
        """Return it with the prior of weights of the whole rig, shape (n, j), or with none."""
        return replace(self, prior=None if weights is None else self.of_rig(weights))

    def of_rig(self, weights: NDArray) -> NDArray[np.float32]:
        """Return weights of the rig at these points and joints; rows sum to one, or to zero."""
        part = np.asarray(weights, np.float64)[np.ix_(self.vertices, self.deform)]
        total = part.sum(axis=1, keepdims=True)
        return np.divide(part, total, out=np.zeros_like(part), where=total > 0).astype(np.float32)


def sample_rig(rig: Rig, count: int = 0, seed: int = 0) -> Sample:
    """Draw points from the welded vertices of a rig.

    Parameters
    ----------
    rig : Rig
    count : int
        Points; 0 for all.
    seed : int
        The same points for the same seed.

    Returns
    -------
    Sample
        Without prior; its target are the rig's own weights.

    Raises
    ------
    WeightsError
        The rig has weights, but none on the joints that may carry some.
    """
    welded = _Welded.of(rig)
    chosen = np.arange(len(welded.places))
    if 0 < count < len(chosen):
        chosen = np.sort(np.random.default_rng(seed).choice(chosen, count, replace=False))
    sample = _sample(rig, welded, chosen)
    if rig.weights is None:
        return sample
    target = sample.of_rig(rig.weights)
    if not target.any():
        raise WeightsError(f'rig "{rig.name}": no point that was drawn has weight')
    return replace(sample, target=target)


def deal_rig(rig: Rig, count: int) -> Iterator[Sample]:
    """Deal all welded vertices of a rig into samples as large as those of a training.

    Neighbours are farther apart where fewer points are drawn: to a network a sample of all
    vertices is not what it learned from.
    """
    welded = _Welded.of(rig)
    order = np.random.default_rng(0).permutation(len(welded.places))
    for chosen in np.array_split(order, max(1, round(len(order) / count))):
        yield _sample(rig, welded, np.sort(chosen))


@dataclass(frozen=True, eq=False)
class _Welded:
    """The welded vertices that faces use."""

    places: NDArray[np.float64]  # (k, 3), in longest sides
    faces: NDArray[np.int32]  # (m, 3)
    normals: NDArray  # (k, 3), float32
    vertices: NDArray[np.int64]  # (k,), the first vertex of the rig at each place

    @classmethod
    def of(cls, rig: Rig) -> _Welded:
        used, corners = np.unique(rig.mesh.welded.faces, return_inverse=True)
        faces = np.asarray(corners.reshape(-1, 3), np.int32)
        vertices = rig.mesh.welded.first[used].astype(np.int64)
        places = rig.mesh.vertices[vertices]
        return cls(places / longest_side(rig.mesh), faces, mesh_normals(places, faces)[1], vertices)


def _sample(rig: Rig, welded: _Welded, chosen: NDArray) -> Sample:
    size, middle = longest_side(rig.mesh), rig.mesh.bounds.mean(axis=0)
    deform = np.flatnonzero(rig.skeleton.deform)
    joints, tails, parents = bones_of(rig.skeleton, deform)
    vertices = welded.vertices[chosen]
    return Sample(
        rig.name,
        ((rig.mesh.vertices[vertices] - middle) / size).astype(np.float32),
        welded.normals[chosen],
        ((joints - middle) / size).astype(np.float32),
        ((tails - middle) / size).astype(np.float32),
        parents,
        None,
        None,
        _along_surface(welded.places, welded.faces, chosen),
        vertices,
        deform,
    )


def bones_of(skeleton: Skeleton, chosen: NDArray) -> tuple[NDArray, NDArray, NDArray[np.int64]]:
    """Return joints and tails (j, 3) of the chosen joints, and their parents among them (j,)."""
    tails = skeleton.joints.copy()
    for joint, below in enumerate(skeleton.children):
        if len(below):
            tails[joint] = skeleton.joints[below].mean(axis=0)
    place = np.full(len(skeleton.joints), -1)
    place[chosen] = np.arange(len(chosen))
    above = skeleton.parents[chosen].astype(np.int64)
    while (out := (above >= 0) & (place[above] < 0)).any():
        above[out] = skeleton.parents[above[out]]
    return skeleton.joints[chosen], tails[chosen], np.where(above >= 0, place[above], -1)


def _along_surface(places: NDArray, faces: NDArray, chosen: NDArray) -> NDArray[np.int64]:
    """Return the nearest of the chosen vertices along mesh edges, (p, STORED_NEIGHBOURS)."""
    one, other = find_edges(faces.astype(np.int32)).edges.T
    length = np.linalg.norm(places[one] - places[other], axis=1)
    graph = coo_array((length, (one, other)), shape=(len(places), len(places))).tocsr()
    nearest = np.empty((len(chosen), STORED_NEIGHBOURS), np.int64)
    step = max(1, min(512, LENGTHS // len(places)))
    for begin in range(0, len(chosen), step):
        rows = np.arange(begin, min(begin + step, len(chosen)))
        away = dijkstra(graph, directed=False, indices=chosen[rows], limit=FAR)[:, chosen]
        away[np.arange(len(rows)), rows] = np.inf
        count = min(STORED_NEIGHBOURS, len(chosen))
        order = np.sort(np.argpartition(away, count - 1, axis=1)[:, :count], axis=1)
        lengths = np.take_along_axis(away, order, axis=1)
        by_length = np.argsort(lengths, axis=1, kind="stable")
        order = np.take_along_axis(order, by_length, axis=1)
        is_near = np.isfinite(np.take_along_axis(lengths, by_length, axis=1))
        nearest[rows] = rows[:, None]
        nearest[rows, : order.shape[1]] = np.where(is_near, order, rows[:, None])
    return nearest


def hops_between(parents: NDArray) -> NDArray[np.int64]:
    """Count the bones between each two joints, shape (j, j); MAX_HOPS where they are more."""
    children = np.flatnonzero(parents >= 0)
    links = coo_array(
        (np.ones(len(children)), (parents[children], children)), shape=(len(parents),) * 2
    )
    hops = shortest_path(links.tocsr(), directed=False, unweighted=True)
    return np.minimum(hops, MAX_HOPS).astype(np.int64)


def joints_below(parents: NDArray) -> NDArray[np.float32]:
    """Return which joints each joint moves, shape (j, j); see `Skeleton.subtree`."""
    places = np.zeros((len(parents), 3))
    return Skeleton(places, parents).subtree.astype(np.float32)
