"""The character coloured by its weights: of one joint, or of all at once."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from cutcell.rig import Rig

from .character import attachments, body, bones
from .description import Description, Legend
from .palette import UNREACHED, joint_colors, to_bytes

EMPHASIS = 4
"""The power that weights are raised to before their joints' colours are mixed."""


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
        has a colour, and each vertex their mixture, the strongest foremost.
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
    colors, legend = weight_colors(rig, weights, joint)
    actors = {
        "body": body(rig, weights, **colors, **look),
        **attachments(rig),
        "bones": bones(rig, joint if chosen is None else chosen, skeleton),
    }
    return Description(actors, legend=legend)


def weight_colors(
    rig: Rig, weights: ArrayLike, joint: int | None = None
) -> tuple[dict[str, Any], Legend | None]:
    """Return the fields of the body's `Actor` that colour it, and how to read them."""
    weights = np.asarray(weights, float)
    if joint is not None:
        legend = Legend(f"Weight of {rig.skeleton.names[joint]}", "weight", "0", "1")
        return {"scalars": weights[:, joint].astype(np.float32), "colormap": "weight"}, legend
    # Many small weights mix to grey; a power lets the strongest show its colour.
    strong = weights**EMPHASIS
    total = strong.sum(axis=1, keepdims=True)
    mixed = strong @ joint_colors(rig.skeleton.parents) / np.where(total > 0, total, 1)
    mixed = np.where(total > 0, mixed, UNREACHED)
    return {"colors": to_bytes(np.clip(mixed, 0, 1))}, None
