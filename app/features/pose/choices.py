"""Choices of the panel Pose."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import param

from ...document.common import MOMENT
from ...document.state import Panel
from ...looks.pose import SWING

PANEL = Panel(
    "Pose",
    '<circle cx="13" cy="4.5" r="2"/><path d="M13 7.5l-2 6 3.5 2.5 1 5M11 13.5L8 21M5 11.5l'
    '3.5-3L13 8l3 3.5 3.5.5"/>',
    poses=True,
    paints=True,
)


class Choices(param.Parameterized):
    """How the character stands, what moves it, and what it is compared with."""

    if TYPE_CHECKING:
        joint: Any

    axis: param.Selector[str] = param.Selector(
        default="z",
        objects={"about X": "x", "about Y": "y", "about Z": "z"},
        doc="What to swing about.",
    )
    turns = param.Dict({}, doc="Degrees about x, y and z, a triple for each turned joint.")
    clip = param.Integer(
        -1,
        doc="Which clip of the rig to play; -1 swings the joint, -2 goes through the saved poses.",
        precedence=MOMENT,
    )
    moving = param.Boolean(
        False, doc="Whether a motion, rather than `turns`, poses.", precedence=MOMENT
    )
    playing = param.Boolean(False, doc="Whether that motion runs, or is halted.", precedence=MOMENT)

    blending: param.Selector[str] = param.Selector(
        default="linear",
        objects={"Linear": "linear", "Dual quaternions": "dual"},
        doc="How the transforms of joints are blended; the weights are the same.",
    )
    pose_colors: param.Selector[str] = param.Selector(
        default="weights",
        objects=["weights", "plain", "materials"],
        doc="What the moving body's colours tell.",
    )
    materials: Any = param.Parameter(None, doc="`Textures` of the open character, or None.")
    rival: param.Selector[str] = param.Selector(
        default="alone",
        objects={"Alone": "alone", "Ghost": "ghost", "Side by side": "beside"},
        doc="How the same motion with the file's own weights is seen.",
    )
    heat = param.Boolean(False, label="Error as colours")
    errors: Any = param.Parameter(None, doc="DeformationError about the scene's axes, or None.")
    motion_error: Any = param.Parameter(
        None, doc="Root mean square, greatest and nearly greatest mm over the motion, or None."
    )

    pose_name = param.String("", doc="The saved pose that was chosen or saved last.")
    stretches: Any = param.Parameter(
        {}, doc="The `Worst` edge of each saved pose and clip, by (weights, kind) and by its key."
    )

    @property
    def posed(self) -> bool:
        """Whether the character is anywhere but at rest on the panels that pose it."""
        return self.moving or any(any(angles) for angles in self.turns.values())

    @property
    def motion(self) -> str:
        """Names the motion that is on, by what makes it another one; empty without one."""
        if not self.moving:
            return ""
        is_swing = self.clip == SWING
        return f"swing {self.joint} {self.axis}" if is_swing else f"clip {self.clip}"
