"""A body: shapes melted into each other where limbs meet, and kept apart elsewhere."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .sdf import Points, Shape, length, mirrored, smooth_min


@dataclass(frozen=True)
class Part:
    """A shape in a body.

    Parameters
    ----------
    shape : Shape
    joint : str
        The joint that carries it.
    blend : float
        Over what distance it melts into the parts before it.
    at, reach : optional
        Melt only within `reach` of the point `at` (the joint where the limb is attached);
        elsewhere keep apart, however close.
    edge : float
        Wanted length of mesh edges on it.
    colour : str
    carve : bool
        Take it away instead of adding it.
    """

    shape: Shape
    joint: str
    blend: float = 0.02
    at: Points | None = None
    reach: float = 0.1
    edge: float = 0.02
    colour: str = "skin"
    carve: bool = False


@dataclass
class Body:
    """Parts, one melted into the next, and paint on them."""

    parts: list[Part] = field(default_factory=list)
    paint: list[tuple[Shape, str, float]] = field(default_factory=list)

    def add(self, shape: Shape, joint: str, both: Any = False, **options: Any) -> None:
        """Add a part; with `both`, also its reflection on the right-hand side.

        A joint named "x.L" becomes "x.R" there.
        """
        self.parts.append(Part(shape, joint, **options))
        if both:
            at = options.get("at")
            if at is not None:
                options = {**options, "at": np.asarray(at) * [-1, 1, 1]}
            other = joint.replace(".L", ".R")
            self.parts.append(Part(mirrored(shape), other, **options))

    def colour(self, shape: Shape, colour: str, edge: float, both: bool = False) -> None:
        """Paint all that lies inside the shape, with mesh edges of the length `edge`."""
        self.paint.append((shape, colour, edge))
        if both:
            self.paint.append((mirrored(shape), colour, edge))

    def distance(self, points: Points) -> NDArray:
        """Return the signed distance of points (n, 3); fastest when they lie together."""
        centre = (points.min(axis=0) + points.max(axis=0)) / 2
        spread = float(length(points - centre).max())
        total = np.full(len(points), 1e6)
        for part in self.parts:
            gap = float(length(part.shape.centre - centre)) - part.shape.radius - spread
            limit = part.blend - total.min() if part.carve else total.max() + part.blend
            if gap > limit:
                continue  # too far away to change anything here
            total = _joined(part, points, total)
        return total

    def edge_length(self, points: Points, growth: float = 0.3) -> NDArray:
        """Return the wanted length of mesh edges: each part's own near it, growing away."""
        shapes = [(part.shape, part.edge) for part in self.parts]
        shapes += [(shape, edge) for shape, _, edge in self.paint]
        result = np.full(len(points), 1e6)
        for rows in neighbourhoods(points):
            near, lengths = points[rows], result[rows]
            centre = (near.min(axis=0) + near.max(axis=0)) / 2
            spread = float(length(near - centre).max())
            for shape, edge in shapes:
                gap = float(length(shape.centre - centre)) - shape.radius - spread
                if edge + growth * max(gap, 0) < lengths.max():
                    distance = np.maximum(shape.distance(near), 0)
                    lengths = np.minimum(lengths, edge + growth * distance)
            result[rows] = lengths
        return result

    def joint_distances(self, points: Points, names: Iterable[str]) -> NDArray:
        """Return the distance of each point to the parts of each joint, shape (n, j)."""
        columns = {name: k for k, name in enumerate(names)}
        distances = np.full((len(points), len(columns)), np.inf)
        for part in self.parts:
            if not part.carve:
                column = distances[:, columns[part.joint]]
                np.minimum(column, part.shape.distance(points), out=column)
        return distances

    def colours(self, points: Points) -> NDArray:
        """Return the name of each point's colour: its nearest part's, or the paint's."""
        solid = [part for part in self.parts if not part.carve]
        nearest = np.argmin([part.shape.distance(points) for part in solid], axis=0)
        names = np.array([part.colour for part in solid], object)[nearest]
        for shape, colour, _ in self.paint:
            names[shape.distance(points) < 0] = colour
        return names


def neighbourhoods(points: Points, cell: float = 0.1) -> list[NDArray]:
    """Return the rows of points in each cell of space: far parts of a body can be skipped."""
    keys = np.floor((points - points.min(axis=0)) / cell).astype(np.int64)
    code = (keys[:, 0] * 1024 + keys[:, 1]) * 1024 + keys[:, 2]
    order = np.argsort(code, kind="stable")
    return np.split(order, np.flatnonzero(np.diff(code[order])) + 1)


def _joined(part: Part, points: Points, total: NDArray) -> NDArray:
    distance = part.shape.distance(points)
    blend: float | NDArray = part.blend
    if part.at is not None:
        t = np.clip(1 - length(points - part.at) / part.reach, 0, 1)
        blend = part.blend * np.minimum(t * 2, 1) ** 2 * (3 - 2 * np.minimum(t * 2, 1))
    if part.carve:
        return -smooth_min(-total, distance, blend)
    return smooth_min(total, distance, blend)
