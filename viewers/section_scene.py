"""The face of a cut body: the mesh's own section, with a field or the winding number on it."""

from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from cutcell.graph import CutCellGraph
from cutcell.rig import Rig, TriangleMesh

from .character import from_scene, in_scene
from .description import Actor, Cut, Legend, Reading
from .distance_scene import distance_look
from .interpolation import interpolate
from .palette import INTERIOR, Theme
from .plane_section import PlaneSection, plane_section

COARSEST, FINEST = 72, 128
"""Triangles of a section along the longest side of the body."""
BEFORE = 1e-3
"""Distance of lines from the face, towards the eye, relative to the body's longest side."""


def body_section(rig: Rig, graph: CutCellGraph, cut: Cut) -> PlaneSection:
    """Return the section of a rig's mesh in the scene, with faces oriented as in the graph."""
    faces = np.where(graph.inverted[:, None], rig.mesh.faces[:, ::-1], rig.mesh.faces)
    mesh = in_scene(rig, TriangleMesh(rig.mesh.vertices, faces))
    resolution = int(np.clip(1.5 * graph.lattice.resolution, COARSEST, FINEST))
    return plane_section(mesh, cut.origin, cut.normal, resolution)


def field_face(
    rig: Rig,
    graph: CutCellGraph,
    section: PlaneSection,
    threshold: float,
    field: ArrayLike,
    limits: tuple[float, float],
    text: str = "",
) -> Actor:
    """Return the inside of a section as an actor with a field's values.

    Parameters
    ----------
    rig : Rig
    graph : CutCellGraph
    section : PlaneSection
        From `body_section`.
    threshold : float
        Least winding number of the inside.
    field : array_like, shape (N,)
        A distance at each node; infinite where none is known.
    limits : (float, float)
        Of the colours.
    text : str
        The label before the value under the pointer.
    """
    points, faces, _ = section.above(threshold)
    values = interpolate(graph, graph.lattice.to_unit(from_scene(rig, points)), field)
    style, _ = distance_look(values, limits)
    return Actor.solid(points, faces, **style, reading=Reading(text))


def winding_face(section: PlaneSection) -> tuple[Actor, Legend]:
    """Return the winding number all over a section as an actor, and how to read it."""
    pairs = np.stack([section.faces.ravel(), np.round(section.winding.ravel(), 6)], axis=1)
    alike, faces = np.unique(pairs, axis=0, return_inverse=True)
    points, number = section.points[alike[:, 0].astype(int)], alike[:, 1]
    actor = Actor.solid(
        points,
        faces.reshape(-1, 3),
        scalars=np.clip(number, 0, 1),
        colormap="inside",
        reading=Reading("winding number ", number),
    )
    return actor, Legend("Winding number", "inside", "0", "1")


def section_lines(
    section: PlaneSection, threshold: float, cut: Cut, size: float, theme: Theme, contour: bool
) -> tuple[dict[str, Actor], tuple[Any, ...]]:
    """Return the outline of a section, and the contour where it is open, with their swatches.

    Parameters
    ----------
    section : PlaneSection
    threshold : float
        The winding number of the contour.
    cut : Cut
        The plane.
    size : float
        The longest side of the body, in the scene.
    theme : Theme
    contour : bool
        Whether the contour is wanted.
    """
    before = BEFORE * size * np.array(cut.normal)
    outline = Actor.segments(section.outline + before, color=theme.ink, width=1.4)
    actors = {"section outline": outline}
    swatches: tuple[Any, ...] = ((theme.ink, "where the plane meets the mesh"),)
    crossings = section.above(threshold)[2] if contour else ()
    if len(crossings):
        lines = Actor.segments(crossings + 2 * before, color=INTERIOR, width=3.0)
        actors["section contour"] = lines
        swatches += ((INTERIOR, f"where the number is τ = {threshold:g}"),)
    return actors, swatches
