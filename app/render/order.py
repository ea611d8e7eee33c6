"""What is to be drawn of a scene: from where, how large, and whether it moves."""

from __future__ import annotations

from cutcell.rig import Rig
from cutcell.rig.checks import check_choice, check_number
from cutcell_viewers.camera import Camera
from cutcell_viewers.description import Description
from cutcell_viewers.film import Order
from cutcell_viewers.finding_scene import camera_on_marks
from cutcell_viewers.pose_scene import clip_in_scene

from ..scenes.common import camera_on_bone
from .choices import VIEWS, Choices, state_of
from .names import find_clip


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
    camera: Camera | None = None,
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
    camera : Camera, optional
        Where to look from instead of all that, where neither `view` nor `near` is given.

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
    if view is not None or near is not None:
        camera = None
    if choices.finding and camera is None:
        camera = camera_on_marks(description, aspect, direction)
    direction = direction or VIEWS["three-quarter"]
    if near is not None:
        part = check_number("near", near, 0.01, 1)
        camera = camera_on_bone(state_of(rig, choices), part, aspect, direction)
    return Order(description, theme, size, camera, direction, turntable, motion, legend)
