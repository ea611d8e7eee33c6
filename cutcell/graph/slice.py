"""One slice of the lattice and its ray segments (paper section 3.1, figure "ray segments").

`build_graph` handles all rays at once and does not store the segments that it drops. Here the rays
of one slice are divided again, for display.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..errors import ParameterError
from ..method import check_resolution
from ..rig import TriangleMesh
from ..rig.checks import check_choice, check_integer, check_number
from .lattice import Lattice
from .rays import AXES, cast_rays, points_on_rays
from .segments import divide_rays
from .surface import prepare_surface
from .winding.exact import WindingNumbers


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
    kept : array, shape (s,), bool
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
    kept: NDArray[np.bool_]
    crossing: NDArray[np.float64]
    sign: NDArray[np.int8]
    triangle: NDArray[np.int32]
    lattice: Lattice


def slice_rays(
    mesh: TriangleMesh,
    resolution: int,
    *,
    axis: int,
    normal: int,
    index: int,
    winding_threshold: float = 0.5,
    orient: bool = True,
) -> RaySlice:
    """Divide the rays of one slice of the lattice into segments.

    Parameters
    ----------
    mesh : TriangleMesh
    resolution : int
        R, as of `build_graph`.
    axis : int
        Which way the rays run: 0, 1, 2 for x, y, z.
    normal : int
        The axis perpendicular to the slice; not the same as `axis`.
    index : int
        Which slice, from 0 to R - 1: the one at (index + 1/2) / R.
    winding_threshold : float
        tau: segments with at least this winding number are kept.
    orient : bool
        As of `build_graph`.

    Returns
    -------
    RaySlice

    Raises
    ------
    ParameterError
        A parameter is out of its range, or the rays would leave the slice.

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

    surface = prepare_surface(mesh, resolution, orient)
    hits = cast_rays(surface.vertices, surface.faces, resolution, axis)
    rays = np.arange(resolution)
    rays = index * resolution + rays if normal == AXES[axis][0] else rays * resolution + index
    segments = divide_rays(hits, rays, resolution)
    is_shown = segments.has_ends & (segments.low < segments.high)
    low, high = (
        segments.points(position, resolution, axis)[is_shown]
        for position in (segments.low, segments.high)
    )
    winding = WindingNumbers(surface.vertices, surface.faces).at((low + high) / 2)
    ray = np.repeat(np.arange(resolution**2), np.diff(hits.start))
    in_slice = np.isin(ray, rays)
    crossing = points_on_rays(ray[in_slice], hits.position[in_slice], resolution, axis)
    return RaySlice(
        low,
        high,
        winding,
        winding >= threshold,
        crossing,
        hits.sign[in_slice],
        hits.triangle[in_slice],
        surface.lattice,
    )
