"""From bones, a body and colours to a character with one closed mesh."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .body import Body
from .character import Bones, Character, Material, Motion, Surface
from .meshing import mesh_of, normals_of
from .seams import with_seams
from .weights import from_parts


def closed_character(
    name: str,
    bones: Bones,
    body: Body,
    box: ArrayLike,
    spacing: float,
    materials: dict[str, Material],
    motion: Motion,
    detail: float = 1.0,
    smoothing: int = 12,
) -> Character:
    """Mesh the body inside the box (2, 3), weight it, and part it by material.

    `spacing` and `detail` are those of `mesh_of`, `smoothing` that of `from_parts`.
    Vertices on the border of two materials are there twice, as in any GLB file; welded, the
    mesh is closed.
    """
    lower, upper = np.asarray(box, float)
    vertices, faces = mesh_of(body, lower, upper, spacing, detail)
    vertices, faces, colours = with_seams(body, vertices, faces, detail)
    weights = from_parts(body, bones, vertices, faces, smoothing=smoothing)
    normals = normals_of(body, vertices)
    surfaces = []
    for colour, material in materials.items():
        part = faces[colours == colour]
        if len(part):
            used, part = _compact(part)
            surfaces.append(Surface(vertices[used], part, normals[used], weights[used], material))
    return Character(name, bones, surfaces, motion)


def _compact(faces: NDArray) -> tuple[NDArray, NDArray]:
    used, inverse = np.unique(faces, return_inverse=True)
    return used, inverse.reshape(faces.shape)
