"""The connected components of a mesh, and which bones lie inside each of them."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ...geodesics import Bones
from ...geometry.line_hits import LineHits, line_hits
from ...geometry.welded import WeldedMesh
from ...runtime.threads import in_threads

POINTS = 9
"""Samples along each bone."""
MAX_RIGID_SIZE = 0.25
"""Maximum size of rigid accessories and components of one joint, as part of the longest side."""
INSIDE_SHARE = 0.5
"""A point is inside a component if this part of six rays from it leave the component."""


def bone_containment(mesh: WeldedMesh, bones: Bones) -> NDArray[np.float64]:
    """Measure which part of each bone lies inside each component, shape (components, b)."""
    along = (np.arange(POINTS) + 0.5) / POINTS
    samples = bones.start[:, None] + along[:, None] * (bones.end - bones.start)[:, None]
    samples = samples.reshape(-1, 3)

    def hits_along(axis: int) -> list[LineHits]:
        return list(line_hits(mesh.points, mesh.faces, samples, axis))

    hits = [block for blocks in in_threads(hits_along, range(3)) for block in blocks]
    face, sample, ahead, sign = (np.concatenate(parts) for parts in zip(*hits, strict=True))
    sign = np.where(ahead > 0, sign, -sign)
    which = mesh.component[mesh.faces[face, 0]]
    key, number = np.unique(which.astype(np.int64) * len(samples) + sample, return_inverse=True)
    # Each hit belongs to the ray up or to the ray down, one of six.
    inside = np.bincount(number, sign / 6, minlength=len(key)) > INSIDE_SHARE - 1e-9
    containment = np.zeros((len(mesh.longest_sides), len(bones.joint)))
    inside_of, bone = key[inside] // len(samples), key[inside] % len(samples) // POINTS
    np.add.at(containment, (inside_of, bone), 1 / POINTS)
    return containment
