"""Where two sets of weights put the skin apart: in a pose, or in any turn of a joint."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from cutcell.metrics import DeformationError, deformation_error
from cutcell.metrics.deformation import CM2
from cutcell.rig import Rig, Skeleton, TriangleMesh

from .character import attachments, body, bones, to_scene
from .description import Apart, Description, Legend
from .skin import moved, skin_of_weights, squared_apart

FLOOR = 0.1
"""The end of the scale is this many cm² at least: what is less would not be seen."""


def error_scene(
    rig: Rig,
    weights: ArrayLike,
    reference: ArrayLike,
    transforms: ArrayLike,
    *,
    chosen: int | None = None,
    skeleton: bool = True,
) -> Description:
    """Return the scene of a posed character, coloured by how far two weightings part.

    Parameters
    ----------
    rig : Rig
    weights, reference : array_like, shape (n, j)
        The character is posed by the first, and compared with the second.
    transforms : array_like, shape (j, 4, 4)
        Skinning matrices in the rig's space, as from `cutcell.forward_kinematics`.
    chosen : int, optional
        The joint that is highlighted.
    skeleton : bool

    Returns
    -------
    Description
        With the actors "body", "bones" and the attachments.
    """
    from .pose_scene import posed

    apart = Apart(skin_of_weights(reference), squared_unit(rig))
    still = posed(Description(), rig, transforms).pose
    limits = error_limits(rig, weights, apart, still)
    look = error_look(len(rig.mesh.vertices), apart, limits)
    actors = {
        "body": body(rig, weights, **look),
        **attachments(rig),
        "bones": bones(rig, chosen, skeleton),
    }
    return posed(Description(actors, legend=error_legend(limits)), rig, transforms)


def error_look(count: int, apart: Apart, limits: tuple[float, float]) -> dict[str, Any]:
    """Return the fields of the body's `Actor` that show the error while it is posed."""
    values = np.zeros(count, np.float32)
    return {"scalars": values, "colormap": "error", "limits": limits, "apart": apart}


def error_legend(limits: tuple[float, float], reference: str = "the file's own weights") -> Legend:
    """Return the legend of the error; the mesh's longest side counts as one metre."""
    title = f"Apart from {reference}, squared (longest side 1 m)"
    return Legend(title, "error", "0", f"{limits[1]:.3g} cm²")


def error_limits(
    rig: Rig, weights: ArrayLike, apart: Apart, poses: ArrayLike | None
) -> tuple[float, float]:
    """Return the range of the error over one pose or several, (j, 4, 4) or (f, j, 4, 4)."""
    if poses is None:
        return (0.0, FLOOR)
    points, skin = to_scene(rig, rig.mesh.vertices), skin_of_weights(weights)
    poses = np.asarray(poses, float)
    poses = poses[np.newaxis] if poses.ndim == 3 else poses
    top = max(float(squared_apart(points, skin, apart.skin, pose).max()) for pose in poses)
    return (0.0, max(apart.unit * top, FLOOR))


def mean_error(
    rig: Rig, weights: ArrayLike, reference: ArrayLike, pose: ArrayLike
) -> tuple[float, float]:
    """Return the mean and the greatest error of a pose, (j, 4, 4) in the scene's space, in cm²."""
    points = to_scene(rig, rig.mesh.vertices)
    between = moved(points, skin_of_weights(weights), pose)
    between -= moved(points, skin_of_weights(reference), pose)
    squared = squared_unit(rig) * (between * between).sum(axis=1)
    return float(squared.mean()), float(squared.max())


def squared_unit(rig: Rig) -> float:
    """Return what a squared length of 1 in the scene is worth in cm², the longest side 1 m."""
    return CM2 / float(np.ptp(_used(rig), axis=0).max()) ** 2


def scene_error(rig: Rig, weights: ArrayLike, reference: ArrayLike) -> DeformationError:
    """Return the deformation error with turns about the scene's axes, as the page turns joints."""
    mesh = TriangleMesh(to_scene(rig, rig.mesh.vertices), rig.mesh.faces)
    skeleton = rig.skeleton
    joints = to_scene(rig, skeleton.joints)
    parts = (mesh, Skeleton(joints, skeleton.parents, skeleton.names, skeleton.deform))
    return deformation_error(parts, weights, reference)


def _used(rig: Rig) -> NDArray[np.float64]:
    return to_scene(rig, rig.mesh.vertices[np.unique(rig.mesh.faces)])
