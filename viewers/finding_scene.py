"""What a diagnosis found, marked on the character: faces, vertices and joints."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from cutcell.diagnosis import Finding
from cutcell.rig import Rig

from .camera import FRONT, Camera, framing
from .character import to_scene
from .description import Actor
from .marks import beads
from .palette import MARK

MOST_BEADS = 4000
"""Of many vertices, evenly chosen ones are marked."""
VERTEX, JOINT = 0.0022, 0.009
"""Radii of marks, in parts of the diagonal of the character's box."""
NEAREST = 0.2
"""Of the diagonal: a smaller part is seen with what is around it."""


def finding_marks(rig: Rig, finding: Finding) -> dict[str, Actor]:
    """Return marks of what a finding names, drawn over the body.

    Faces, and those of which it names all corners, are painted; other vertices and joints get
    beads.
    """
    actors = {}
    faces, vertices = _painted(rig, finding)
    if len(faces):
        corners = rig.mesh.faces[faces]
        points = to_scene(rig, rig.mesh.vertices[corners.ravel()]).astype(np.float32)
        cells = np.arange(corners.size, dtype=np.int32).reshape(-1, 3)
        actors["finding faces"] = Actor("surface", points, cells, color=MARK, clipped=False)
    size = float(np.linalg.norm(np.ptp(to_scene(rig, rig.mesh.vertices), axis=0)))
    vertices = vertices[:: -(-len(vertices) // MOST_BEADS) or 1]
    for name, places, radius in (
        ("finding vertices", rig.mesh.vertices[vertices], VERTEX),
        ("finding joints", rig.skeleton.joints[finding.joints], JOINT),
    ):
        if len(places):
            points, cells = beads(to_scene(rig, places), radius * size)
            actors[name] = Actor(
                "surface", points.astype(np.float32), cells, color=MARK, clipped=False, overlay=True
            )
    return actors


def _painted(rig: Rig, finding: Finding) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
    """Return the faces to be painted, and the vertices that are not on any of them."""
    named = np.zeros(len(rig.mesh.vertices), bool)
    named[finding.vertices] = True
    faces = np.union1d(finding.faces, np.flatnonzero(named[rig.mesh.faces].all(axis=1)))
    named[rig.mesh.faces[faces]] = False
    return faces, np.flatnonzero(named)


def camera_on(
    rig: Rig, finding: Finding, bounds: NDArray[np.float64], aspect: float = 1.2
) -> Camera | None:
    """Return a camera that sees what a finding names; None if it names nothing.

    Parameters
    ----------
    rig : Rig
    finding : Finding
    bounds : array, shape (2, 3)
        Of the body, in the scene.
    aspect : float
        Width over height of the picture.
    """
    vertices, joints = rig.mesh.vertices, rig.skeleton.joints
    corners = rig.mesh.faces[finding.faces].ravel()
    places = np.concatenate([vertices[finding.vertices], vertices[corners], joints[finding.joints]])
    if not len(places):
        return None
    points = to_scene(rig, places)
    low, high = points.min(axis=0), points.max(axis=0)
    least = NEAREST * float(np.linalg.norm(bounds[1] - bounds[0]))
    more = np.maximum(least - (high - low), 0) / 2
    middle = bounds.mean(axis=0)
    side = (low + high) / 2 - middle
    # From the side that they are on, and still from the front, and never straight from above.
    direction = np.array(FRONT) + 1.5 * side / max(float(np.ptp(bounds, axis=0).max()), 1e-300)
    return framing(np.stack([low - more, high + more]), aspect, tuple(direction.tolist()))
