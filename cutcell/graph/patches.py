"""Patches of a mesh whose faces are consistently oriented: neighbours run alike."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..compiled import compiled
from ..unions import join, numbered
from .mesh_edges import find_edges
from .solid_angle import between, cross, dot, length

NONE = -1
SAME = 0.99
"""Cosine between normals: faces on each other, or nearly so."""


class Patches(NamedTuple):
    """Faces that hang together across manifold edges, and how to make them consistent.

    Parameters
    ----------
    turned : array, shape (m,), bool
        Faces to turn round so that all of a patch run alike.
    patch : array, shape (m,), int32
        The patch of each face, numbered from 0.
    rims : array, shape (s, 2), int32
        Sides that leave patches open, as the faces run once some are turned.
    of_rim : array, shape (s,), int32
        The patch of each.
    """

    turned: NDArray[np.bool_]
    patch: NDArray[np.int32]
    rims: NDArray[np.int32]
    of_rim: NDArray[np.int32]


def find_patches(
    vertices: NDArray[np.float64],
    faces: NDArray[np.int32],
    partner: NDArray[np.int32],
    areas: NDArray[np.float64],
) -> Patches:
    """Orient faces consistently, component by component.

    Two faces that alone share an edge are consistent if they use it in opposite directions. Of
    the two ways to orient a component, the one stays that turns less area. A component that
    cannot be oriented (a Moebius strip) is left as it is, and falls into several patches.

    Parameters
    ----------
    vertices : array, shape (n, 3)
    faces : array, shape (m, 3), int32
        Welded.
    partner : array, shape (3 m,), int32
        See `mesh_edges.MeshEdges`.
    areas : array, shape (m,)
    """
    turned, patch, is_plain, is_orientable = _flood(faces, partner, areas)
    if is_plain:
        return Patches(turned, patch, np.empty((0, 2), np.int32), np.empty(0, np.int32))
    if turned.any() or not is_orientable:
        partner = _part_doubled(vertices, faces, partner)
        turned, patch, _, is_orientable = _flood(faces, partner, areas)
    if not is_orientable:
        patch = _split(faces, partner, turned)
    return Patches(turned, patch, *_rims(faces, partner, turned, patch))


def _part_doubled(
    vertices: NDArray[np.float64], faces: NDArray[np.int32], partner: NDArray[np.int32]
) -> NDArray[np.int32]:
    """Return the partners without those that lie on each other and look the same way.

    Such faces are there twice. To turn one of them would make a body without volume.
    """
    side = np.flatnonzero(partner >= 0)
    start = faces.ravel()
    side = side[start[side] == start[partner[side]]]
    corners = vertices[faces[np.stack([side, partner[side]]) // 3]]
    normals = np.cross(corners[:, :, 1] - corners[:, :, 0], corners[:, :, 2] - corners[:, :, 0])
    sizes = np.linalg.norm(normals, axis=2).prod(axis=0)
    same = np.einsum("ij,ij->i", *normals) > SAME * sizes
    partner = partner.copy()
    partner[side[same]] = NONE
    return partner


def inconsistent_faces(
    vertices: NDArray[np.float64], faces: NDArray[np.int32]
) -> NDArray[np.bool_]:
    """Tell which welded faces run against most of those they hang together with, shape (m,)."""
    areas, _ = measure_faces(vertices, faces)
    return find_patches(vertices, faces, find_edges(faces).partner, areas).turned


@compiled
def measure_faces(vertices, faces):
    """Return each face's area, and the signed volume between it and the middle of the unit cube."""
    areas, volumes = np.empty(len(faces)), np.empty(len(faces))
    middle = 0.5, 0.5, 0.5
    for f in range(len(faces)):
        a, b, c = vertices[faces[f, 0]], vertices[faces[f, 1]], vertices[faces[f, 2]]
        normal = cross(between(a, b), between(a, c))
        areas[f], volumes[f] = length(normal) / 2, dot(between(middle, a), normal) / 6
    return areas, volumes


@compiled
def _flood(faces, partner, areas):
    """Spread the orientation of one face over each component.

    Returns which faces to turn, and their components; whether all of these are closed and
    consistent as they are, and whether all can be oriented.
    """
    turned, patch = np.zeros(len(faces), np.bool_), np.full(len(faces), NONE, np.int32)
    found = np.empty(len(faces), np.int32)  # faces in the order in which they are reached
    count, reached, is_plain, is_orientable = 0, 0, True, True
    for seed in range(len(faces)):
        if patch[seed] != NONE:
            continue
        begin, is_consistent, as_is, balance = reached, True, True, 0.0
        found[reached], patch[seed] = seed, count
        reached += 1
        done = begin
        while done < reached:
            f = found[done]
            done += 1
            balance += -areas[f] if turned[f] else areas[f]
            for side in range(3 * f, 3 * f + 3):
                other = partner[side]
                if other == NONE:
                    is_plain = False
                    continue
                g = other // 3
                # Consistent neighbours start the shared edge at its two different ends.
                against = faces[f, side % 3] == faces[g, other % 3]
                if patch[g] == NONE:
                    patch[g], turned[g] = count, turned[f] != against
                    as_is &= not turned[g]
                    found[reached] = g
                    reached += 1
                elif turned[g] != (turned[f] != against):
                    is_consistent = False
        if not is_consistent:
            is_orientable = False
        is_plain &= as_is
        for k in range(begin, begin if as_is else reached):
            f = found[k]
            turned[f] = is_consistent and turned[f] == (balance >= 0)
        count += 1
    return turned, patch, is_plain and is_orientable, is_orientable


@compiled
def _split(faces, partner, turned):
    """Give each patch of consistent faces a number."""
    first = np.arange(len(faces))
    for side in range(len(partner)):
        other = partner[side]
        if other < side:
            continue
        if _is_consistent(faces, turned, side, other):
            join(first, side // 3, other // 3)
    return numbered(first)[0]


@compiled
def _rims(faces, partner, turned, patch):
    """List the sides that no consistent face adjoins, and the patches that they bound."""
    is_open = np.zeros(len(partner), np.bool_)
    for side in range(len(partner)):
        other = partner[side]
        is_open[side] = other == NONE or not _is_consistent(faces, turned, side, other)
    found = np.flatnonzero(is_open)
    rims, of_rim = np.empty((len(found), 2), np.int32), np.empty(len(found), np.int32)
    for s in range(len(found)):
        f, k = found[s] // 3, found[s] % 3
        start, end = faces[f, k], faces[f, (k + 1) % 3]
        rims[s, 0], rims[s, 1] = (end, start) if turned[f] else (start, end)
        of_rim[s] = patch[f]
    return rims, of_rim


@compiled(inline="always")
def _is_consistent(faces, turned, side, other):
    """Tell whether two faces that share an edge use it in opposite directions, once turned."""
    f, g = side // 3, other // 3
    against = faces[f, side % 3] == faces[g, other % 3]
    return against == (turned[f] != turned[g])
