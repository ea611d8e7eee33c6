"""One slice of the lattice with its rays (paper section 3.1, figure "ray segments")."""

from functools import partial

import numpy as np
from numpy.typing import NDArray

from cutcell.graph import Lattice
from cutcell.rig import Rig

from .character import cell_length, lattice_to_scene
from .description import Actor, Cut, Legend, Reading
from .marks import beads, rods
from .palette import BONE_IDLE, INTERIOR, MARK, SURFACE, Theme
from .plane_section import plane_outline
from .ray_slice import RaySlice

INSIDE, DROPPED = 0.13, 0.045
"""Thickness of kept and dropped segments, in cells of the lattice."""
DIFFERENT = 0.3
"""Thickness of segments that two methods decide differently, in cells."""
BEAD = 0.2
MARGIN = 1.5
"""Length of rays beyond the body, in cells."""
ALIKE = 0.005
"""Largest difference of winding numbers that share one label."""


def slice_scene(
    rig: Rig, rays: RaySlice, theme: Theme, reference: RaySlice | None = None
) -> tuple[dict[str, Actor], Legend]:
    """Return a slice's rays as actors, and how to read them.

    Parameters
    ----------
    rig : Rig
    rays : RaySlice
        Of the rig's mesh.
    theme : Theme
    reference : RaySlice, optional
        The same slice by other means: segments that it decides otherwise are marked.

    Returns
    -------
    actors : dict of str to Actor
        "slice rays", thick where kept and coloured by the winding number; "slice crossings",
        "slice points" (of the lattice, inside) and "slice outline" (of the mesh); with a
        reference, "slice differences".
    legend : Legend
    """
    lattice = rays.lattice
    cell, placed = cell_length(rig, lattice), partial(lattice_to_scene, rig, lattice)
    margin = MARGIN / lattice.resolution
    box = lattice.to_unit(rig.mesh.bounds) + np.array([[-margin], [margin]])
    low, high, winding, is_inside = _joined(rays, box)
    size = cell * np.where(is_inside, INSIDE, DROPPED)
    points, faces, of = rods(placed(low), placed(high), size)
    number = winding[of]
    actors = {
        "slice rays": Actor.solid(
            points,
            faces,
            scalars=np.clip(number, 0, 1),
            colormap="winding",
            reading=Reading("winding number ", number),
        )
    }
    tips = rays.high[rays.inside]
    cells = tips * lattice.resolution - 0.5
    inside = tips[(np.abs(cells - cells.round()) < 1e-9).all(axis=1)]
    for name, at, color in (
        ("slice points", inside, INTERIOR),
        ("slice crossings", rays.crossing, SURFACE),
    ):
        points, faces = beads(placed(at), BEAD * cell)
        actors[name] = Actor.solid(points, faces, color=color)
    marks = [(INTERIOR, "thick: kept"), (BONE_IDLE, "thin: dropped"), (SURFACE, "crossings")]
    if reference is not None:
        differs, missed = rays.decided_otherwise(reference), reference.decided_otherwise(rays)
        start, end = (
            placed(np.concatenate([ends[differs], others[missed]]))
            for ends, others in ((rays.low, reference.low), (rays.high, reference.high))
        )
        points, faces, _ = rods(start, end, DIFFERENT * cell)
        if len(points):
            actors["slice differences"] = Actor.solid(points, faces, color=MARK)
        count = max(int(differs.sum()), int(missed.sum()))
        marks.append((MARK, f"decided otherwise: {count:,} of {len(rays.low):,}"))
    normal = np.eye(3)[np.argmin(np.ptp(rays.low, axis=0) + np.ptp(rays.high, axis=0))]
    vertices = lattice.to_unit(rig.mesh.vertices)
    ends = placed(plane_outline(vertices, rig.mesh.faces, rays.low[0], normal))
    actors["slice outline"] = Actor.segments(ends, color=theme.mesh_edge)
    return actors, Legend("Winding number", "winding", "0", "1", tuple(marks))


def slice_place(rig: Rig, axis: str, position: float, resolution: int) -> tuple[int, int, Cut]:
    """Return which slice of the lattice lies at a part of the body's box.

    Parameters
    ----------
    rig : Rig
    axis : {"x", "y", "z"}
        Of the scene: the slice's normal.
    position : float
        From 0 to 1 across the box of the faces.
    resolution : int

    Returns
    -------
    normal : int
        The axis of the rig's own space that is nearest to it.
    index : int
        The slice, from 0 to R - 1.
    cut : Cut
        The plane of the slice, which clips the near side.
    """
    normal, sign = file_axis(rig, axis)
    lattice = Lattice.around(rig.mesh, resolution)
    low, high = lattice.to_unit(rig.mesh.bounds)
    part = position if sign > 0 else 1 - position
    level = low[normal] + part * (high[normal] - low[normal])
    index = int(np.clip(level * resolution, 0, resolution - 1))
    place = lattice.to_unit(np.mean(rig.mesh.bounds, axis=0))
    place[normal] = (index + 0.5) / resolution
    direction = sign * rig.world[:3, normal]
    direction = direction / np.linalg.norm(direction)
    origin = lattice_to_scene(rig, lattice, place)
    return normal, index, Cut(tuple(origin.tolist()), tuple(direction.tolist()))


def file_axis(rig: Rig, axis: str) -> tuple[int, int]:
    """Return the axis of the rig's space nearest to one of the scene's, and its direction."""
    row = rig.world["xyz".index(axis), :3]
    nearest = int(np.argmax(np.abs(row)))
    return nearest, 1 if row[nearest] > 0 else -1


def _joined(
    rays: RaySlice, box: NDArray[np.float64]
) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64], NDArray[np.bool_]]:
    """Join similar neighbouring segments, and drop segments far from the body."""
    middle = (rays.low + rays.high) / 2
    near = ((middle >= box[0]) & (middle <= box[1])).all(axis=1)
    low, high, winding, is_inside = (
        values[near] for values in (rays.low, rays.high, rays.winding, rays.inside)
    )
    follows = (np.abs(low[1:] - high[:-1]) < 1e-12).all(axis=1)
    alike = (is_inside[1:] == is_inside[:-1]) & (np.abs(winding[1:] - winding[:-1]) < ALIKE)
    first = np.flatnonzero(np.concatenate([[True], ~(follows & alike)]))
    last = np.append(first[1:], len(low)) - 1
    return low[first], high[last], winding[first], is_inside[first]
