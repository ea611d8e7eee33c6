"""Where two sets of weights put the skin apart: in a pose, or in any turn of a joint."""

from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from cutcell.rig import Rig

from .character import attachments, body, bones, pose_in_scene, to_scene
from .description import Apart, Description, Legend
from .skin import skin_of_weights

FLOOR = 3.0
"""The end of the scale is this many millimetres at least: less would not be visible."""

WHOLE = 0.995
"""The scale holds this part of the vertices: a single one would leave all others grey."""


class Gap:
    """Measures how far apart two sets of weights move each vertex.

    Parameters
    ----------
    rig : Rig
    weights, reference : array_like, shape (n, j)
        Rows sum to one, or to zero where a vertex stands still.
    """

    def __init__(self, rig: Rig, weights: ArrayLike, reference: ArrayLike) -> None:
        self._points = to_scene(rig, rig.mesh.vertices).astype(np.float32)
        # A vertex without weight follows an additional joint, which never moves.
        weights_a, weights_b = (_with_rest(np.asarray(w, np.float32)) for w in (weights, reference))
        self._between = weights_a - weights_b
        self._unit = millimetres(rig)

    def lengths(self, pose: ArrayLike) -> NDArray[np.float32]:
        """Return the distances in mm on a character whose longest side is 1 m, shape (n,).

        Parameters
        ----------
        pose : array_like, shape (j, 4, 4)
            In the scene's space.
        """
        matrices = np.asarray(pose, np.float32)[:, :3].reshape(-1, 12)
        matrices = np.vstack([matrices, np.eye(3, 4, dtype=np.float32).ravel()])
        blended = (self._between @ matrices).reshape(-1, 3, 4)
        displacement = (blended[:, :, :3] @ self._points[:, :, None])[:, :, 0] + blended[:, :, 3]
        return np.asarray(self._unit * np.linalg.norm(displacement, axis=1), np.float32)


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
    pose = pose_in_scene(rig, transforms)
    limits = error_limits(Gap(rig, weights, reference).lengths(pose))
    apart = Apart(skin_of_weights(reference), millimetres(rig))
    style = error_look(len(rig.mesh.vertices), apart, limits)
    actors = {
        "body": body(rig, weights, **style),
        **attachments(rig),
        **bones(rig, chosen, skeleton),
    }
    return Description(actors, pose=pose, legend=error_legend(limits))


def error_look(count: int, apart: Apart, limits: tuple[float, float]) -> dict[str, Any]:
    """Return the fields of the body's `Actor` that show the error while it is posed."""
    values = np.zeros(count, np.float32)
    return {"scalars": values, "colormap": "error", "limits": limits, "apart": apart}


def error_legend(limits: tuple[float, float]) -> Legend:
    """Return the legend of the error."""
    return Legend("Error against the file's weights", "error", "0", f"{limits[1]:g} mm")


def error_limits(lengths: ArrayLike) -> tuple[float, float]:
    """Return a range that contains nearly all errors; its end is a round number.

    Round numbers stay the same while a joint turns a little: the colours can be compared.
    """
    top = max(float(np.quantile(np.asarray(lengths), WHOLE)), FLOOR)
    power = 10.0 ** np.floor(np.log10(top))
    step = next(step for step in (1, 1.5, 2, 3, 5, 7, 10) if step * power >= top * (1 - 1e-9))
    return (0.0, float(step * power))


def millimetres(rig: Rig) -> float:
    """Return the mm of a length of 1 in the scene, where the longest side is 1 m."""
    used = to_scene(rig, rig.mesh.vertices[np.unique(rig.mesh.faces)])
    return 1000 / float(np.ptp(used, axis=0).max())


def _with_rest(weights: NDArray[np.float32]) -> NDArray[np.float32]:
    return np.hstack([weights, (weights.sum(axis=1, keepdims=True) <= 0).astype(np.float32)])
