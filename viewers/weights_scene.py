"""The character coloured by its weights: of one joint, or of all at once."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from cutcell.rig import Rig

from .character import attachments, body, bones
from .description import Description, Legend
from .palette import joint_colors, to_bytes


def weights_scene(
    rig: Rig,
    weights: ArrayLike,
    joint: int | None = None,
    *,
    skeleton: bool = True,
    chosen: int | None = None,
    **look: Any,
) -> Description:
    """Return the scene of a weight matrix.

    Parameters
    ----------
    rig : Rig
    weights : array_like, shape (n, j)
    joint : int, optional
        Whose weights to show, from grey (none) to dark red (all). Without it every joint
        has a colour, and each vertex their mixture.
    skeleton : bool
        Whether the bones are seen.
    chosen : int, optional
        The joint that is highlighted; `joint` when left out.
    **look
        Other fields of the body's `Actor`.

    Returns
    -------
    Description
        With the actors "body", "bones" and "attachment 0", "attachment 1", ...
    """
    weights = np.asarray(weights, float)
    legend = None
    if joint is None:
        colors = weights @ joint_colors(rig.skeleton.parents)
        colors += (1 - np.minimum(weights.sum(axis=1, keepdims=True), 1)) * 0.5
        look["colors"] = to_bytes(np.clip(colors, 0, 1))
    else:
        look.update(scalars=weights[:, joint].astype(np.float32), colormap="weight")
        legend = Legend(f"Weight of {rig.skeleton.names[joint]}", "weight", "0", "1")
    actors = {
        "body": body(rig, weights, **look),
        **attachments(rig),
        "bones": bones(rig, joint if chosen is None else chosen, skeleton),
    }
    return Description(actors, legend=legend)
