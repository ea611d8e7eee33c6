"""Order of a picture of a scene: camera, size and motion."""

from dataclasses import dataclass

from cutcell.checks import check_choice, check_number
from cutcell.errors import ParameterError
from cutcell.rig import Rig
from cutcell_viewers.camera import FRONT, Camera
from cutcell_viewers.description import Description
from cutcell_viewers.finding_scene import camera_on_marks
from cutcell_viewers.order import Order, ground
from cutcell_viewers.pose_scene import clip_in_scene

from ..document.framing import camera_on_bone
from .address import read_camera
from .choices import Choices, state_of
from .names import clip_named

VIEWS = {
    "three-quarter": FRONT,
    "front": (0.0, 0.06, 1.0),
    "left": (1.0, 0.06, 0.0),
    "right": (-1.0, 0.06, 0.0),
    "back": (0.0, 0.06, -1.0),
    "top": (0.0, 1.0, 0.02),
}
"""Directions of view; left and right are the character's own."""


@dataclass(frozen=True)
class Picture:
    """Options of a picture.

    Parameters
    ----------
    size : (int, int)
        Width and height in pixels.
    view : str, optional
        One of `VIEWS`. When left out: the side that a finding is on, else three-quarter.
    turntable : bool
        Whether the camera goes once around.
    legend : bool
    near : float, optional
        Extent of the visible part around the bone, in parts of the longest side.
    camera : str, optional
        Position of the camera and its target, as addresses write them.
    background : str, optional
        A colour instead of the theme's background.
    transparent : bool
    """

    size: tuple[int, int] = (1600, 1200)
    view: str | None = None
    turntable: bool = False
    legend: bool = True
    near: float | None = None
    camera: str | None = None
    background: str | None = None
    transparent: bool = False

    @property
    def ground(self) -> str:
        """The background as an `Order` has it."""
        return "transparent" if self.transparent else self.background or ""

    def check(self, kind: str = ".png") -> None:
        """Raise a `ParameterError` for wrong or contradicting options, before long work."""
        if self.view is not None:
            check_choice("view", self.view, VIEWS)
        if self.near is not None:
            check_number("near", self.near, 0.01, 1)
        if self.camera is not None:
            read_camera(self.camera)
            if self.view is not None or self.near is not None:
                raise ParameterError("camera is where to look from: leave out view and near")
        if self.transparent and self.background:
            raise ParameterError("a transparent picture has no background: leave one of them out")
        ground("light", self.ground, kind)


def order(
    rig: Rig,
    description: Description,
    choices: Choices,
    picture: Picture | None = None,
    eye: Camera | None = None,
) -> Order:
    """Return the order of a picture, or of a film if the camera or the character moves.

    The description is that of the choices; `eye` is the camera of a picture whose options set none.
    """
    picture = picture or Picture()
    picture.check()
    view, near, aspect = picture.view, picture.near, picture.size[0] / picture.size[1]
    direction = None if view is None else VIEWS[view]
    camera = eye if view is None and near is None else None
    if picture.camera is not None:
        camera = read_camera(picture.camera)
    elif near is not None:
        state = state_of(rig, choices)
        camera = camera_on_bone(state, near, aspect, direction or FRONT)
    elif choices.finding and camera is None:
        camera = camera_on_marks(description, aspect, direction)
    motion = None
    if choices.clip is not None and choices.time is None:
        motion = clip_in_scene(rig, clip_named(rig, choices.clip))
    return Order(
        description, "dark" if choices.dark else "light", picture.size, camera,
        direction or FRONT, picture.turntable, motion, picture.legend, background=picture.ground,
    )  # fmt: skip
