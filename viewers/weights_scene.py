"""The character coloured by its weights: of one joint, or of all at once."""

from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from cutcell.rig import Rig

from .character import attachments, body, bones
from .description import Description, Legend, Reading
from .joint_colors import colors_of
from .palette import UNREACHED, to_bytes
from .short_names import short_names

MIXED = "Each bone's colour, mixed by weight"
MOST = "Dominant bone"


def weights_scene(
    rig: Rig,
    weights: ArrayLike,
    joint: int | None = None,
    *,
    skeleton: bool = True,
    chosen: int | None = None,
    **style: Any,
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
        "body": body(rig, weights, **colors, **style),
        **attachments(rig),
        **bones(
            rig,
            joint if chosen is None else chosen,
            skeleton,
            colors_of(rig) if joint is None else None,
        ),
    }
    return Description(actors, legend=legend)


def weight_colors(
    rig: Rig, weights: ArrayLike, joint: int | None = None
) -> tuple[dict[str, Any], Legend]:
    """Return the fields of the body's `Actor` that colour it, and how to read them."""
    if joint is not None:
        name = short_names(rig.skeleton.names)[joint]
        legend = Legend(f"Weight of {name}", "weight", "0", "1")
        scalars = np.ascontiguousarray(np.asarray(weights)[:, joint], np.float32)
        return {"scalars": scalars, "colormap": "weight", "reading": Reading(f"{name} ")}, legend
    colors = to_bytes(np.clip(_mixed(rig, np.asarray(weights)), 0, 1))
    return {"colors": colors, "reading": _strongest(rig, weights)}, Legend(MIXED)


def _mixed(rig: Rig, weights: NDArray) -> NDArray[np.float64]:
    """Mix the colours of joints by vertex; most weights are zero, and cost nothing."""
    count, joints = weights.shape
    weighted = np.flatnonzero(weights > 0)
    vertex = weighted // joints
    joint = weighted - vertex * joints
    # Many small weights mix to grey; a power lets the strongest show its colour.
    strong = np.square(np.square(weights.ravel()[weighted]))
    total = np.bincount(vertex, strong, count)[:, None]
    channels = colors_of(rig).T
    mixed = [np.bincount(vertex, strong * channel[joint], count) for channel in channels]
    blended = np.stack(mixed, axis=1) / np.where(total > 0, total, 1)
    return np.where(total > 0, blended, UNREACHED)


def dominant_colors(rig: Rig, weights: ArrayLike) -> tuple[dict[str, Any], Legend]:
    """Colour each vertex by the joint that holds most of it; see `weight_colors`."""
    reading = _strongest(rig, weights)
    colors = to_bytes(colors_of(rig))
    assert reading.values is not None
    style = {"colors": colors[reading.values.astype(int)], "reading": reading}
    return style, Legend(MOST)


def count_colors(rig: Rig, weights: ArrayLike) -> tuple[dict[str, Any], Legend]:
    """Colour each vertex by the number of joints that it follows; see `weight_colors`."""
    count = (np.asarray(weights) > 0).sum(axis=1).astype(np.float32)
    most = max(int(count.max(initial=1)), 2)
    legend = Legend("Influences", "count", "1", f"{most}")
    style = {"scalars": count, "colormap": "count", "limits": (1.0, float(most))}
    return {**style, "reading": Reading("joints: ")}, legend


def difference_colors(
    rig: Rig, weights: ArrayLike, other: ArrayLike
) -> tuple[dict[str, Any], Legend]:
    """Colour each vertex by the part of its weight that two matrices give to different joints.

    See `weight_colors`.
    """
    moved = np.abs(np.asarray(weights, np.float32) - np.asarray(other, np.float32)).sum(axis=1) / 2
    legend = Legend("Difference to the file's weights", "error", "0%", "100%")
    style = {"scalars": moved.astype(np.float32), "colormap": "error", "limits": (0.0, 1.0)}
    return {**style, "reading": Reading("Weights differ from the file's by ", percent=True)}, legend


def bone_difference_colors(
    rig: Rig, weights: ArrayLike, truth: ArrayLike, joint: int, names: tuple[str, str]
) -> tuple[dict[str, Any], Legend]:
    """Colour each vertex by what one matrix gives to a joint beyond what another does.

    Parameters
    ----------
    rig : Rig
    weights, truth : array_like, shape (n, j)
    joint : int
    names : (str, str)
        What the two are called.

    Returns
    -------
    look, legend
        As `weight_colors`.
    """
    name = short_names(rig.skeleton.names)[joint]
    more = np.asarray(weights)[:, joint] - np.asarray(truth)[:, joint]
    title = f"Weight of {name}: {names[0]} minus {names[1]}"
    legend = Legend(title, "difference", "\N{MINUS SIGN}1", "+1")
    style = {"scalars": more.astype(np.float32), "colormap": "difference", "limits": (-1.0, 1.0)}
    return {**style, "reading": Reading(f"{name} ")}, legend


def _strongest(rig: Rig, weights: ArrayLike) -> Reading:
    return Reading("", np.asarray(weights).argmax(axis=1).astype(np.float32), rig.skeleton.names)
