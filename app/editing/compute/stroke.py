"""One stroke of a brush over a mesh, and the weights that come of it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any, Literal, get_args

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array, diags_array
from scipy.sparse.linalg import splu
from scipy.spatial import cKDTree

from cutcell.checks import check_choice, check_number
from cutcell.editing.locks import joint_index
from cutcell.editing.symmetry import Mirror
from cutcell.errors import ParameterError
from cutcell.geometry.laplacian import cotangent_laplacian
from cutcell.rig import Rig, TriangleMesh

from .reach import SurfaceReach
from .selected import Selected, rows_at

BrushMode = Literal["add", "subtract", "replace", "smooth"]

FARTHEST = 1e30
SPREAD = 1 / 8
"""Squared radii: for how long weights diffuse where they are smoothed, so that after it a point is
half a radius wide (a standard deviation along each axis)."""
MIN_AREA = 1e-12
"""Minimum area around a vertex, as a share of the largest, for faces without any area."""
ON_THE_OTHER_SIDE = 0.25
"""Radii: how far from a vertex a mirrored stroke may pass to touch the surface there."""


@dataclass(frozen=True)
class Brush:
    """A brush.

    Parameters
    ----------
    radius : float
        Over the surface, in the file's units. The brush is strongest in the middle; towards its
        rim, where it does nothing, it falls as (1 - t²)².
    mode : {"add", "subtract", "replace", "smooth"}
        Change of the weight of a joint: add the strength, subtract it, or go that part of
        the way to the value. Or it goes that part of the way to weights of all joints that
        diffused over the surface.
    strength : float
        0 to 1. A whole stroke changes no vertex by more, however often it passes over.
    value : float
        0 to 1, what weights are replaced by.

    Raises
    ------
    ParameterError
        One of them is out of its range.
    """

    radius: float
    mode: BrushMode = "add"
    strength: float = 1.0
    value: float = 1.0

    def __post_init__(self) -> None:
        object.__setattr__(self, "radius", check_number("radius", self.radius, 0, FARTHEST))
        if self.radius == 0:
            raise ParameterError("radius must be more than 0")
        object.__setattr__(self, "mode", check_choice("mode", self.mode, get_args(BrushMode)))
        for name in ("strength", "value"):
            object.__setattr__(self, name, check_number(name, getattr(self, name), 0, 1))


class PaintSurface:
    """Data that all strokes over one mesh share."""

    def __init__(self, mesh: TriangleMesh) -> None:
        self.reach, self.size = SurfaceReach.of(mesh), mesh.cube.size

    def prepare(self) -> None:
        """Compute the data of strokes in advance, so that the first stroke does not wait."""
        _ = self._used, self.diffusion

    @cached_property
    def _used(self) -> tuple[NDArray[np.int32], Any]:
        """The welded vertices that faces have, and a tree of them."""
        used = np.unique(self.reach.mesh.faces)
        return used, cKDTree(self.reach.points[used])

    def nearest(
        self, places: NDArray[np.float64], limit: float
    ) -> tuple[NDArray[np.bool_], NDArray[np.int32]]:
        """Return which positions have a vertex within a limit, and the nearest of these."""
        used, tree = self._used
        gap, near = tree.query(places, distance_upper_bound=limit)
        is_near = np.isfinite(gap)
        return is_near, used[near[is_near]]

    @cached_property
    def diffusion(self) -> tuple[csr_array, NDArray[np.float64]]:
        """The Laplacian with no negative weight, so that nothing overshoots; and areas."""
        mesh = self.reach.mesh
        flow = cotangent_laplacian(mesh.points, mesh.faces)
        flow.setdiag(0)
        flow.data = np.maximum(-flow.data, 0)
        laplacian = csr_array(diags_array(flow.sum(axis=1)) - flow)
        areas = np.maximum(mesh.areas, MIN_AREA * mesh.areas.max())
        return laplacian, areas * self.size**2


class Stroke:
    """One stroke of a brush: vertices are painted once, however often it passes.

    See `paint_weights` for the parameters; `weights`, (n, j), which may be sparse, are those before
    the stroke.
    """

    def __init__(
        self,
        surface: PaintSurface,
        rig: Rig,
        weights: NDArray[np.float64] | csr_array,
        joint: int | str,
        brush: Brush,
        *,
        mirror: Mirror | None = None,
        locked: Sequence[int | str] = (),
        max_influences: int | None = None,
        within: NDArray[np.bool_] | None = None,
        locked_weights: NDArray[np.bool_] | None = None,
    ) -> None:
        self._within = np.ones(weights.shape[0], bool) if within is None else within
        self._surface, self._rig, self._weights, self._brush = surface, rig, weights, brush
        self._mirror = mirror
        none = np.empty(0, np.intp)
        self._all = Selected(rig, weights, none, locked, max_influences, locked_weights)
        joint = joint_index(rig.skeleton, joint)
        partner = -1 if mirror is None else int(mirror.joint[joint])
        self._joints = [joint] if partner < 0 else [joint, partner]
        if brush.mode != "smooth":
            for one in self._joints:
                self._all.joint(one)
        sides = 1 if mirror is None or (partner < 0 and brush.mode != "smooth") else 2
        self._distance = np.full((sides, len(surface.reach.points)), np.inf)
        self._before = self._distance.copy()

    def pass_over(self, corners: NDArray[np.integer], shares: NDArray[np.float64]) -> None:
        """Lead the brush over points of the surface.

        Shapes: corners (s, c), shares (s, c).
        """
        reach = self._surface.reach
        welded = reach.index[corners]
        around = reach.points[welded]
        points = (around * shares[:, :, None]).sum(axis=1)
        begin = np.linalg.norm(around - points[:, None], axis=2)
        self._accumulate(0, welded.ravel(), begin.ravel())
        if len(self._distance) < 2:
            return
        mirror = self._mirror
        assert mirror is not None
        points, around = points.copy(), around.reshape(-1, 3).copy()
        for positions in (points, around):
            positions[:, mirror.axis] = 2 * mirror.position - positions[:, mirror.axis]
        is_near, near = self._surface.nearest(around, ON_THE_OTHER_SIDE * self._brush.radius)
        point = np.repeat(np.arange(len(points)), corners.shape[1])[is_near]
        self._accumulate(1, near, np.linalg.norm(reach.points[near] - points[point], axis=1))

    def _accumulate(
        self, side: int, vertices: NDArray[np.integer], begin: NDArray[np.float64]
    ) -> None:
        far = self._surface.reach.distances(vertices, begin, self._brush.radius)
        np.minimum(self._distance[side], far, out=self._distance[side])

    def touched(self) -> NDArray[np.intp]:
        """Return the vertices that were touched so far, shape (v,)."""
        near = self._distance.min(axis=0) < self._brush.radius
        return np.flatnonzero(near[self._surface.reach.index] & self._within)

    def covered(self) -> tuple[NDArray[np.intp], NDArray[np.float64]]:
        """Return the vertices that were touched so far, and how strongly, shapes (v,)."""
        vertices = self.touched()
        return vertices, self._cover().max(axis=0)[self._surface.reach.index[vertices]]

    def _cover(self) -> NDArray[np.float64]:
        """Return how strongly each side of the stroke covers welded vertices."""
        inside = np.maximum(1 - np.square(self._distance / self._brush.radius), 0)
        return np.asarray(self._brush.strength * np.square(inside))

    def continued(self) -> tuple[NDArray[np.intp], NDArray[np.float64]]:
        """Return what `painted` returns, of the vertices that changed since the last call."""
        nearer = np.asarray((self._distance < self._before).any(axis=0))
        self._before = self._distance.copy()
        vertices = self.touched()
        if self._brush.mode != "smooth":  # which spreads over all that is touched
            vertices = vertices[nearer[self._surface.reach.index[vertices]]]
        return vertices, self._weights_of(vertices)

    def painted(self) -> tuple[NDArray[np.intp], NDArray[np.float64]]:
        """Return the vertices that were touched so far, shape (v,), and their weights, (v, j)."""
        vertices = self.touched()
        return vertices, self._weights_of(vertices)

    def _weights_of(self, vertices: NDArray[np.intp]) -> NDArray[np.float64]:
        """Return the weights of touched vertices, shape (v, j)."""
        brush, index = self._brush, self._surface.reach.index
        covered = self._cover()
        if not len(vertices):
            return rows_at(self._weights, vertices)
        selected, cover = replace(self._all, vertices=vertices), covered[:, index[vertices]]
        rows = selected.rows
        if brush.mode == "smooth":
            goal = self._diffused(covered.max(axis=0), vertices)
            moved = rows + cover.max(axis=0)[:, None] * (goal - rows)
        elif len(cover) == 2 and self._joints[0] == self._joints[-1]:
            moved = rows + self._weight_delta(selected, cover.max(axis=0), self._joints[0])
        else:
            changes = zip(self._joints, cover, strict=True)
            moved = rows + sum(self._weight_delta(selected, part, joint) for joint, part in changes)
        named = [] if brush.mode == "smooth" else self._joints
        return selected.finished(moved, named)

    def check_unlocked(self) -> None:
        """Raise an error if the joint is locked at all vertices that were touched."""
        if self._brush.mode != "smooth":
            replace(self._all, vertices=self.touched()).check_unlocked(*self._joints)

    def _weight_delta(
        self, selected: Selected, cover: NDArray[np.float64], joint: int
    ) -> NDArray[np.float64]:
        """Return the change of a joint's weight, and the opposite changes of unlocked joints."""
        rows = selected.rows
        others = np.where(selected.stays, 0.0, rows)
        weight, others[:, joint] = rows[:, joint], 0.0
        rest = others.sum(axis=1)
        step = {
            "add": cover, "subtract": -cover, "replace": cover * (self._brush.value - weight),
        }[self._brush.mode]  # fmt: skip
        can = selected.takes(joint) & (rest > 0)
        step = np.where(can, np.clip(step, -weight, rest), 0.0)
        change = others * np.divide(-step, rest, out=np.zeros_like(rest), where=rest > 0)[:, None]
        change[:, joint] = step
        return change

    def _diffused(
        self, cover: NDArray[np.float64], vertices: NDArray[np.intp]
    ) -> NDArray[np.float64]:
        """Return weights of covered vertices after diffusion within the brush."""
        reach = self._surface.reach
        laplacian, areas = self._surface.diffusion
        inner = np.flatnonzero(cover > 0)
        rows = laplacian[inner]
        around = np.union1d(rows.indices, inner)
        first = reach.mesh.first
        start = rows_at(self._weights, first[around])
        used = np.flatnonzero(start.any(axis=0))
        is_inner = cover[around] > 0
        time, area = SPREAD * self._brush.radius**2, areas[inner]
        system = csr_array(diags_array(area) + time * rows[:, inner]).tocsc()
        right = area[:, None] * start[np.ix_(is_inner, used)]
        right -= time * (rows[:, around[~is_inner]] @ start[np.ix_(~is_inner, used)])
        goal = np.zeros((len(inner), start.shape[1]))
        goal[:, used] = splu(system).solve(right)
        return goal[np.searchsorted(inner, reach.index[vertices])]
