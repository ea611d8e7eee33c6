"""The face of a cut body: the mesh's own section, with a field or the winding number on it."""

from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.spatial import cKDTree

from cutcell.graph import CutCellGraph
from cutcell.rig import Rig, TriangleMesh

from .description import Actor, Cut, Legend, Reading
from .distance_scene import distance_look
from .palette import INTERIOR, Theme
from .plane_section import COARSEST, FINEST, PlaneSection, from_scene, part_above, plane_section

NEAREST = 16
"""How many nodes each value is fitted to."""
REACH = 1.3
"""How far nodes count for it, in cells of the lattice."""
STEEPEST = 1.8
"""Nodes whose values differ by more than this, times their distance, lie on another limb: paths
of six directions are up to the square root of 3 longer than straight lines."""
BEFORE = 1e-3
"""How far lines lie before the face, in parts of the body's longest side."""


def body_section(rig: Rig, graph: CutCellGraph, cut: Cut) -> PlaneSection:
    """Return the section of a rig's mesh, with faces oriented as in the graph."""
    faces = np.where(graph.inverted[:, None], rig.mesh.faces[:, ::-1], rig.mesh.faces)
    resolution = int(np.clip(1.5 * graph.lattice.resolution, COARSEST, FINEST))
    return plane_section(rig, TriangleMesh(rig.mesh.vertices, faces), cut, resolution)


def field_face(
    rig: Rig,
    graph: CutCellGraph,
    section: PlaneSection,
    threshold: float,
    field: ArrayLike,
    limits: tuple[float, float],
    text: str = "",
) -> Actor:
    """Return what of a section is inside as an actor with a field's values.

    Parameters
    ----------
    rig : Rig
    graph : CutCellGraph
    section : PlaneSection
        From `body_section`.
    threshold : float
        Inside is where the winding number is at least this.
    field : array_like, shape (N,)
        A distance at each node; infinite where none is known.
    limits : (float, float)
        Of the colours.
    text : str
        The label before the value under the pointer.
    """
    points, faces, _ = part_above(section, threshold)
    values = values_at(graph, graph.lattice.to_unit(from_scene(rig, points)), field)
    style, _ = distance_look(values, limits)
    return _face(points, faces, **style, reading=Reading(text))


def winding_face(section: PlaneSection) -> tuple[Actor, Legend]:
    """Return the winding number all over a section as an actor, and how to read it."""
    pairs = np.stack([section.faces.ravel(), np.round(section.winding.ravel(), 6)], axis=1)
    alike, faces = np.unique(pairs, axis=0, return_inverse=True)
    points, number = section.points[alike[:, 0].astype(int)], alike[:, 1]
    actor = _face(
        points,
        faces.reshape(-1, 3),
        scalars=np.clip(number, 0, 1).astype(np.float32),
        colormap="inside",
        reading=Reading("winding number ", number.astype(np.float32)),
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
    actors = {"section outline": _lines(section.outline + before, theme.ink, 1.4)}
    swatches: tuple[Any, ...] = ((theme.ink, "where the plane meets the mesh"),)
    passed = part_above(section, threshold)[2] if contour else ()
    if len(passed):
        actors["section contour"] = _lines(passed + 2 * before, INTERIOR, 3.0)
        swatches += ((INTERIOR, f"where the number is τ = {threshold:g}"),)
    return actors, swatches


def values_at(
    graph: CutCellGraph, points: NDArray[np.float64], field: ArrayLike
) -> NDArray[np.float64]:
    """Return a field's values at points (p, 3) of the unit cube, shape (p,).

    Each is that of the linear function that fits the values at near nodes best, the nearer ones
    more (moving least squares), without nodes that are near through the air alone.
    """
    field = np.asarray(field, float)
    nodes = np.flatnonzero(graph.connected)
    if not len(nodes) or not len(points):
        return np.full(len(points), np.inf)
    count = min(NEAREST, len(nodes))
    far, near = cKDTree(graph.nodes[nodes]).query(points, k=list(range(1, count + 1)))
    near = nodes[near]
    value, place = field[near], graph.nodes[near]
    first = np.where(np.isfinite(value[:, :1]), value[:, :1], 0.0)
    steep = STEEPEST * np.linalg.norm(place - place[:, :1], axis=2) + 1e-9
    reach = np.maximum(REACH / graph.lattice.resolution, far[:, :1])
    with np.errstate(invalid="ignore"):
        counts = np.isfinite(value) & (np.abs(value - first) <= steep)
    share = np.exp(-((far / reach) ** 2)) * counts
    away = np.where(counts, value - first, 0.0)
    away_from = (place - points[:, None]) / reach[..., None]
    basis = np.concatenate([np.ones((*far.shape, 1)), away_from], axis=2)
    moments = np.einsum("pk,pki,pkj->pij", share, basis, basis)
    moments += np.diag([1e-12, 1e-5, 1e-5, 1e-5]) * (share.sum(axis=1) + 1e-12)[:, None, None]
    fitted = np.linalg.solve(moments, np.einsum("pk,pk,pki->pi", share, away, basis)[..., None])
    low = np.where(counts, away, np.inf).min(axis=1)
    high = np.where(counts, away, -np.inf).max(axis=1)
    spread = 0.5 / graph.lattice.resolution
    crossings = first[:, 0] + np.clip(fitted[:, 0, 0], low - spread, high + spread)
    return np.where(np.isfinite(value[:, 0]), np.maximum(crossings, 0.0), np.inf)


def _face(points: NDArray, faces: NDArray, **style: Any) -> Actor:
    return Actor(
        "surface", points.astype(np.float32), faces.astype(np.int32), clipped=False, **style
    )


def _lines(ends: NDArray, color: Any, width: float) -> Actor:
    return Actor(
        "lines",
        ends.reshape(-1, 3).astype(np.float32),
        np.arange(2 * len(ends), dtype=np.int32).reshape(-1, 2),
        color=color,
        width=width,
        clipped=False,
    )
