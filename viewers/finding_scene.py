"""Findings of a diagnosis, marked on the character: faces, vertices and joints."""

import numpy as np
from numpy.typing import NDArray

from cutcell.diagnosis import Finding
from cutcell.pose import rotate_joint
from cutcell.rig import Rig

from .camera import FRONT, Camera, framing
from .character import diagonal, pose_in_scene, to_scene
from .description import Actor, Description
from .marks import beads
from .palette import MARK
from .skin import Skin

MAX_BEADS = 4000
"""Largest number of marked vertices; of more, evenly spaced ones are marked."""
VERTEX, JOINT = 0.0022, 0.009
"""Radii of marks, in parts of the diagonal of the character's box."""
NEAREST = 0.2
"""Smallest size of the framed part, relative to the diagonal."""


def finding_marks(rig: Rig, finding: Finding) -> dict[str, Actor]:
    """Return marks of the faces, vertices and joints that a finding names.

    Faces, and those with all corners named, are painted; other vertices and joints get beads.
    They follow the joints by the file's weights, which such findings are about.
    """
    actors = {}
    faces, vertices = _painted(rig, finding)
    if len(faces):
        corners = rig.mesh.faces[faces]
        points = to_scene(rig, rig.mesh.vertices[corners.ravel()])
        cells = np.arange(corners.size).reshape(-1, 3)
        skin = _skin_of_vertices(rig, corners.ravel())
        actors["finding faces"] = Actor.solid(points, cells, color=MARK, skin=skin)
    vertices = vertices[:: -(-len(vertices) // MAX_BEADS) or 1]
    joints = rig.skeleton.joints[finding.joints]
    for name, places, radius, skin in (
        ("finding vertices", rig.mesh.vertices[vertices], VERTEX, _skin_of_vertices(rig, vertices)),
        ("finding joints", joints, JOINT, Skin.rigid(finding.joints)),
    ):
        if len(places):
            points, cells = beads(to_scene(rig, places), radius * diagonal(rig))
            skin = skin and skin.subset(np.arange(len(points)) * len(places) // len(points))
            actors[name] = Actor.solid(points, cells, color=MARK, overlay=True, skin=skin)
    return actors


def finding_pose(rig: Rig, finding: Finding) -> NDArray[np.float64] | None:
    """Return the pose that shows a finding, in the scene, (j, 4, 4); None for rest."""
    if finding.pose is None or rig.weights is None:
        return None
    pose = finding.pose
    return pose_in_scene(rig, rotate_joint(rig.skeleton, pose.joint, pose.axis, pose.degrees))


def _skin_of_vertices(rig: Rig, vertices: NDArray[np.integer]) -> Skin | None:
    return None if rig.weights is None else Skin.of_weights(rig.weights[vertices])


def _painted(rig: Rig, finding: Finding) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
    """Return the painted faces, and the named vertices that are not on any of them."""
    named = np.zeros(len(rig.mesh.vertices), bool)
    named[finding.vertices] = True
    faces = np.union1d(finding.faces, np.flatnonzero(named[rig.mesh.faces].all(axis=1)))
    named[rig.mesh.faces[faces]] = False
    return faces, np.flatnonzero(named)


def camera_on(
    rig: Rig, finding: Finding, bounds: NDArray[np.float64], aspect: float = 1.2
) -> Camera | None:
    """Return a camera that sees all that a finding names; None if it names nothing.

    Parameters
    ----------
    rig : Rig
    finding : Finding
    bounds : array, shape (2, 3)
        Of the body, in the scene.
    aspect : float
        Width over height of the picture.
    """
    marks = Description(finding_marks(rig, finding), pose=finding_pose(rig, finding))
    return camera_on_marks(marks, aspect, bounds=bounds)


def camera_on_marks(
    description: Description,
    aspect: float,
    direction: tuple[float, float, float] | None = None,
    bounds: NDArray[np.float64] | None = None,
) -> Camera | None:
    """Return a camera that sees the marks of a scene; None if there are none.

    The direction is by default from the side of the marks. The bounds are those of the body, by
    default of the scene.
    """
    marks = [actor for name, actor in description.actors.items() if name.startswith("finding")]
    points = [actor.points_in(description.pose, description.blending) for actor in marks]
    if not points:
        return None
    low, high = (end(np.concatenate(points), axis=0) for end in (np.min, np.max))
    bounds = description.bounds if bounds is None else bounds
    least = NEAREST * float(np.linalg.norm(bounds[1] - bounds[0]))
    padding = np.maximum(least - (high - low), 0) / 2
    middle = bounds.mean(axis=0)
    side = (low + high) / 2 - middle
    if direction is None:
        # From their side, and still from the front, and never straight from above.
        towards = np.array(FRONT) + 1.5 * side / max(float(np.ptp(bounds, axis=0).max()), 1e-300)
        direction = tuple(towards.tolist())
    return framing(np.stack([low - padding, high + padding]), aspect, direction)
