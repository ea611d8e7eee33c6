"""Request for a picture of a scene: camera, size and motion."""

from dataclasses import replace

from cutcell.errors import ParameterError
from cutcell.rig import Rig
from cutcell.rig.checks import check_choice, check_number
from cutcell_viewers.camera import Camera
from cutcell_viewers.description import Description
from cutcell_viewers.film import Order, ground
from cutcell_viewers.finding_scene import camera_on_marks
from cutcell_viewers.pose_scene import clip_in_scene

from ..scenes.common import camera_on_bone
from .address import read_camera
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
    camera: str | None = None,
    background: str = "",
    transparent: bool = False,
    eye: Camera | None = None,
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
    camera : str, optional
        Where to look from, as addresses write it.
    background : str
        A colour instead of the theme's background.
    transparent : bool
    eye : Camera, optional
        Where to look from if nothing else says it.

    Raises
    ------
    ParameterError
        See `check_picture`.
    """
    check_picture(view=view, near=near, camera=camera, background=background)
    direction = None if view is None else VIEWS[check_choice("view", view, VIEWS)]
    motion = None
    if choices.clip is not None and choices.time is None:
        clip = find_clip(rig, choices.clip)
        motion = clip_in_scene(rig, clip)
    theme = "dark" if choices.dark else "light"
    aspect = size[0] / size[1]
    looking = eye if view is None and near is None else None
    if camera is not None:
        looking = read_camera(camera)
    if choices.finding and looking is None:
        looking = camera_on_marks(description, aspect, direction)
    direction = direction or VIEWS["three-quarter"]
    if near is not None:
        part = check_number("near", near, 0.01, 1)
        looking = camera_on_bone(state_of(rig, choices), part, aspect, direction)
    order = Order(description, theme, size, looking, direction, turntable, motion, legend)
    return replace(order, background="transparent" if transparent else background)


def check_picture(
    *,
    view: str | None = None,
    near: float | None = None,
    camera: str | None = None,
    background: str = "",
    transparent: bool = False,
    kind: str = ".png",
    **others: object,
) -> None:
    """Raise an error for what no picture follows, before anything is computed.

    Raises
    ------
    ParameterError
        No such view, camera or colour; or two options that contradict each other.
    """
    if view is not None:
        check_choice("view", view, VIEWS)
    if camera is not None:
        read_camera(camera)
        if view is not None or near is not None:
            raise ParameterError("camera is where to look from: leave out view and near")
    if transparent and background:
        raise ParameterError("a transparent picture has no background: leave one of them out")
    ground("light", "transparent" if transparent else background, kind)
