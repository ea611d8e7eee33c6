"""What is to be drawn of a scene: from where, how large, and whether it moves."""

import numpy as np

from cutcell.rig import Rig
from cutcell.rig.checks import check_choice, check_number
from cutcell_viewers.camera import Camera, framing
from cutcell_viewers.character import drawn_segments
from cutcell_viewers.description import Description
from cutcell_viewers.film import Order
from cutcell_viewers.finding_scene import camera_on_marks
from cutcell_viewers.pose_scene import clip_in_scene

from ..scenes.common import first_joint
from .choices import VIEWS, Choices
from .names import find_bone, find_clip


def order(
    rig: Rig,
    description: Description,
    choices: Choices,
    *,
    size: tuple[int, int] = (1600, 1200),
    view: str | None = None,
    turntable: bool = False,
    legend: bool = True,
    near: float | None = None,
) -> Order:
    """Return what is to be drawn: a picture, or a film where it turns or moves.

    Parameters
    ----------
    rig : Rig
    description : Description
        From `describe`, for the same choices.
    choices : Choices
    size : (int, int)
        Width and height in pixels.
    view : str, optional
        One of `VIEWS`. When left out: the side that a finding is on, else three-quarter.
    turntable : bool
        The camera goes once around.
    legend : bool
    near : float, optional
        How much is seen around the bone, in parts of the longest side.

    Raises
    ------
    ParameterError
        No such view.
    """
    direction = None if view is None else VIEWS[check_choice("view", view, VIEWS)]
    motion = None
    if choices.clip is not None and choices.time is None:
        clip = find_clip(rig, choices.clip)
        motion = clip_in_scene(rig, clip)
    theme = "dark" if choices.dark else "light"
    aspect = size[0] / size[1]
    camera = camera_on_marks(description, aspect, direction) if choices.finding else None
    direction = direction or VIEWS["three-quarter"]
    if near is not None:
        camera = _near(
            rig, description, choices, check_number("near", near, 0.01, 1), aspect, direction
        )
    return Order(description, theme, size, camera, direction, turntable, motion, legend)


def _near(
    rig: Rig,
    description: Description,
    choices: Choices,
    part: float,
    aspect: float,
    direction: tuple[float, float, float],
) -> Camera:
    """Return a camera that looks at the middle of the chosen bone, at rest."""
    start, end, of = drawn_segments(rig)
    of_bone = of == (first_joint(rig) if choices.bone is None else find_bone(rig, choices.bone))
    ends = np.concatenate([start[of_bone], end[of_bone]]) if of_bone.any() else description.bounds
    half = part / 2 * float(np.ptp(description.bounds, axis=0).max())
    middle = ends.mean(axis=0)
    return framing(np.stack([middle - half, middle + half]), aspect, direction)
