"""Consistently oriented patches of a mesh."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...geometry.triangles import label_components, normals
from ...geometry.vectors import between, dot, length, triangle_normal
from ...geometry.welded import WeldedMesh
from ...runtime.compiled import compiled

NONE = -1
SAME_NORMAL = 0.99
"""Cosine between the normals of duplicate faces, at least."""


class Patches(NamedTuple):
    """Faces connected across manifold edges, and which to flip to make them consistent.

    Parameters
    ----------
    flips : array, shape (m,), bool
        Inconsistently oriented faces: to be flipped.
    patch : array, shape (m,), int32
        The patch of each face, numbered from 0.
    rims : array, shape (s, 2), int32
        Boundary edges of the patches, in the direction of the flipped faces.
    of_rim : array, shape (s,), int32
        The patch of each.
    """

    flips: NDArray[np.bool_]
    patch: NDArray[np.int32]
    rims: NDArray[np.int32]
    of_rim: NDArray[np.int32]


def find_patches(mesh: WeldedMesh, areas: NDArray[np.float64]) -> Patches:
    """Orient faces consistently, component by component.

    Two faces at a manifold edge are consistent if they traverse it in opposite directions. Of
    the two orientations of a component, the one that flips less area is taken. A component that
    is not orientable (a Moebius strip) is left as it is, and divided into several patches.

    Shapes: areas (m,).
    """
    faces, partner = mesh.faces, mesh.edges.partner
    flips, patch, is_plain, is_orientable = _flood(faces, partner, areas)
    if is_plain:
        return Patches(flips, patch, np.empty((0, 2), np.int32), np.empty(0, np.int32))
    if flips.any() or not is_orientable:
        partner = _without_duplicates(mesh)
        flips, patch, _, is_orientable = _flood(faces, partner, areas)
    if not is_orientable:
        patch = _split(faces, partner, flips)
    return Patches(flips, patch, *_rims(faces, partner, flips, patch))


def _without_duplicates(mesh: WeldedMesh) -> NDArray[np.int32]:
    """Return the partners without pairs of duplicate faces, which have the same normal.

    To flip one of them would enclose a body without volume.
    """
    faces, partner = mesh.faces, mesh.edges.partner
    half_edge = np.flatnonzero(partner >= 0)
    start = faces.ravel()
    half_edge = half_edge[start[half_edge] == start[partner[half_edge]]]
    corners = mesh.points[faces[np.stack([half_edge, partner[half_edge]]) // 3]]
    pairs = normals(corners)
    sizes = np.linalg.norm(pairs, axis=2).prod(axis=0)
    same = np.einsum("ij,ij->i", *pairs) > SAME_NORMAL * sizes
    partner = partner.copy()
    partner[half_edge[same]] = NONE
    return partner


@compiled
def measure_faces(vertices, faces):
    """Return the area of each face, and its signed volume with the middle of the unit cube."""
    areas, volumes = np.empty(len(faces)), np.empty(len(faces))
    middle = 0.5, 0.5, 0.5
    for f in range(len(faces)):
        a, b, c = vertices[faces[f, 0]], vertices[faces[f, 1]], vertices[faces[f, 2]]
        normal = triangle_normal(a, b, c)
        areas[f], volumes[f] = length(normal) / 2, dot(between(middle, a), normal) / 6
    return areas, volumes


@compiled
def _flood(faces, partner, areas):
    """Propagate the orientation of one face over each component.

    Returns which faces to flip, and their components; whether all components are closed and
    consistent as they are; and whether all are orientable.
    """
    flips, patch = np.zeros(len(faces), np.bool_), np.full(len(faces), NONE, np.int32)
    queue = np.empty(len(faces), np.int32)  # faces in the order in which they are reached
    count, reached, is_plain, is_orientable = 0, 0, True, True
    for seed in range(len(faces)):
        if patch[seed] != NONE:
            continue
        begin, is_consistent, as_is, signed_area = reached, True, True, 0.0
        queue[reached], patch[seed] = seed, count
        reached += 1
        done = begin
        while done < reached:
            f = queue[done]
            done += 1
            signed_area += -areas[f] if flips[f] else areas[f]
            for half_edge in range(3 * f, 3 * f + 3):
                other = partner[half_edge]
                if other == NONE:
                    is_plain = False
                    continue
                g = other // 3
                # Consistent neighbours traverse the shared edge in opposite directions.
                against = faces[f, half_edge % 3] == faces[g, other % 3]
                if patch[g] == NONE:
                    patch[g], flips[g] = count, flips[f] != against
                    as_is &= not flips[g]
                    queue[reached] = g
                    reached += 1
                elif flips[g] != (flips[f] != against):
                    is_consistent = False
        if not is_consistent:
            is_orientable = False
        is_plain &= as_is
        for k in range(begin, begin if as_is else reached):
            f = queue[k]
            flips[f] = is_consistent and flips[f] == (signed_area >= 0)
        count += 1
    return flips, patch, is_plain and is_orientable, is_orientable


def _split(
    faces: NDArray[np.int32], partner: NDArray[np.int32], flips: NDArray[np.bool_]
) -> NDArray[np.int32]:
    """Return the patch of each face: faces connected across consistent edges."""
    half_edge = np.flatnonzero((partner != NONE) & _is_consistent(faces, partner, flips))
    return label_components(np.stack([half_edge, partner[half_edge]], axis=1) // 3, len(faces))


def _rims(
    faces: NDArray[np.int32],
    partner: NDArray[np.int32],
    flips: NDArray[np.bool_],
    patch: NDArray[np.int32],
) -> tuple[NDArray[np.int32], NDArray[np.int32]]:
    """List the boundary edges of the patches, (s, 2), and the patch of each, (s,)."""
    half_edge = np.flatnonzero((partner == NONE) | ~_is_consistent(faces, partner, flips))
    face, corner = np.divmod(half_edge, 3)
    rims = np.stack([faces[face, corner], faces[face, (corner + 1) % 3]], axis=1)
    return np.where(flips[face, None], rims[:, ::-1], rims), patch[face]


def _is_consistent(
    faces: NDArray[np.int32], partner: NDArray[np.int32], flips: NDArray[np.bool_]
) -> NDArray[np.bool_]:
    """Return where two faces traverse their shared edge in opposite directions, once flipped."""
    against = faces.ravel() == faces.ravel()[partner]
    is_consistent: NDArray[np.bool_] = against == (np.repeat(flips, 3) != flips[partner // 3])
    return is_consistent
