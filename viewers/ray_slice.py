"""One slice of the lattice and its ray segments (paper section 3.1, figure "ray segments").

`build_graph` handles all rays at once and does not store the segments that it drops. Here the rays
of one slice are divided again, to be shown.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from cutcell.checks import check_choice, check_integer, check_number
from cutcell.errors import ParameterError
from cutcell.graph.lattice import Lattice
from cutcell.graph.libraries import CASTERS, fast_winding_numbers
from cutcell.graph.rays import AXES, cast_rays, part_at_contacts, points_on_rays
from cutcell.graph.segments import divide_rays
from cutcell.graph.surface import prepare_surface
from cutcell.graph.winding.exact import WindingNumbers
from cutcell.method import check_resolution
from cutcell.rig import TriangleMesh


@dataclass(frozen=True, eq=False)
class RaySlice:
    """Parallel rays in one plane of the lattice, divided at ray hits and lattice points.

    Positions are in the unit cube.

    Parameters
    ----------
    low, high : arrays, shape (s, 3), float64
        The ends of each segment, ray by ray, upward, without those at the wall of the cube,
        which lack an end.
    winding : array, shape (s,), float64
        The winding number at each segment's midpoint.
    inside : array, shape (s,), bool
        Whether it is at least tau.
    crossing : array, shape (c, 3), float64
        Ray hits.
    sign : array, shape (c,), int8
        +1 where a ray leaves through a triangle's back, -1 where it enters.
    triangle : array, shape (c,), int32
    lattice : Lattice
    """

    low: NDArray[np.float64]
    high: NDArray[np.float64]
    winding: NDArray[np.float64]
    inside: NDArray[np.bool_]
    crossing: NDArray[np.float64]
    sign: NDArray[np.int8]
    triangle: NDArray[np.int32]
    lattice: Lattice

    def decided_otherwise(self, reference: RaySlice) -> NDArray[np.bool_]:
        """Return whether only one of two slices counts each midpoint as inside, (s,), bool.

        `reference` has the same mesh, resolution, slice and direction of rays.
        """
        axis = int(np.argmax((self.high - self.low).sum(axis=0)))
        scale = np.full(3, self.lattice.resolution)
        scale[axis] = 0

        def along(points: NDArray[np.float64]) -> NDArray[np.float64]:
            """Return one number a point (k, 3), ascending ray by ray."""
            return np.floor(points * scale).sum(axis=1) * 2 + points[:, axis]

        middle = along((self.low + self.high) / 2)
        start, end = along(reference.low), along(reference.high)
        if not len(start):
            return self.inside
        last = np.searchsorted(start, middle, side="right") - 1
        inside = (last >= 0) & (middle <= end[last]) & reference.inside[last]
        return np.asarray(inside != self.inside)


def slice_rays(
    mesh: TriangleMesh,
    resolution: int,
    *,
    axis: int,
    normal: int,
    index: int,
    winding_threshold: float = 0.5,
    orient: bool = True,
    fill: bool = True,
    rays: str = "raster",
    winding: str = "exact",
) -> RaySlice:
    """Divide the rays of one slice of the lattice into segments.

    Parameters
    ----------
    mesh : TriangleMesh
    resolution : int
        R, as of `build_graph`.
    axis : int
        Direction of the rays: 0, 1, 2 for x, y, z.
    normal : int
        The axis perpendicular to the slice; not the same as `axis`.
    index : int
        From 0 to R - 1: the slice at (index + 1/2) / R.
    winding_threshold : float
        tau: least winding number of segments that are kept.
    orient : bool
    fill : bool
        Whether hollow bodies are full, as by `build_graph` unless the connectivity is 6.
    rays : {"raster", "open3d", "embree"}
    winding : {"exact", "fast"}
        As of `build_graph`.

    Returns
    -------
    RaySlice

    Raises
    ------
    ParameterError
        A parameter is out of its range, or the rays would leave the slice.
    MissingLibraryError
        `rays` or `winding` names a library that is not installed.

    References
    ----------
    Paper section 3.1, figure "ray segments".
    """
    resolution = check_resolution(resolution)
    check_choice("axis", axis, (0, 1, 2))
    check_choice("normal", normal, (0, 1, 2))
    if axis == normal:
        raise ParameterError(f"axis and normal are both {axis}; rays lie in their slice")
    index = check_integer("index", index, 0, resolution - 1)
    threshold = check_number("winding_threshold", winding_threshold, 0, 1)
    check_choice("rays", rays, ("raster", *CASTERS))
    check_choice("winding", winding, ("exact", "fast"))

    surface = prepare_surface(mesh, resolution, orient, fill)
    caster = CASTERS.get(rays, cast_rays)
    hits = caster(surface.vertices, surface.faces, resolution, axis)
    hits = part_at_contacts(hits, surface.part)
    numbers = np.arange(resolution)
    first = normal == AXES[axis][0]
    numbers = index * resolution + numbers if first else numbers * resolution + index
    whole = np.tile(np.array([0, resolution], np.int32), (resolution**2, 1))
    segments = divide_rays(hits, axis, resolution, numbers, whole)
    low, high = (
        np.where(is_hit, np.append(hits.position, 0.0)[hit], (segments.number + half) / resolution)
        for is_hit, hit, half in (
            (segments.from_hit, segments.gap - 1, -0.5),
            (segments.to_hit, segments.gap, 0.5),
        )
    )
    shown = np.flatnonzero(low < high)
    low, high = (
        points_on_rays(segments.ray[shown], ends[shown], resolution, axis) for ends in (low, high)
    )
    middle = segments.midpoints(shown)
    if winding == "exact":
        at_middle = WindingNumbers(surface.vertices, surface.faces).at(middle)
    else:
        at_middle = fast_winding_numbers(surface.vertices, surface.faces, middle)
    ray = np.repeat(np.arange(resolution**2), np.diff(hits.start))
    in_slice = np.isin(ray, numbers)
    return RaySlice(
        low,
        high,
        at_middle,
        at_middle >= threshold,
        points_on_rays(ray[in_slice], hits.position[in_slice], resolution, axis),
        hits.sign[in_slice],
        hits.triangle[in_slice],
        surface.lattice,
    )
