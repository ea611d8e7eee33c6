"""Choices of the panel Pose."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import param


class PoseChoices(param.Parameterized):
    """How the character stands, what moves it, and what it is compared with."""

    if TYPE_CHECKING:
        joint: Any

    axis: param.Selector[str] = param.Selector(
        default="z", objects=["x", "y", "z"], doc="What to swing about."
    )
    turns = param.Dict({}, doc="Degrees about x, y and z, a triple for each turned joint.")
    clip = param.Integer(-1, doc="Which clip of the rig to play; -1 swings the joint.")
    moving = param.Boolean(False, doc="Whether a motion, rather than `turns`, poses.")
    playing = param.Boolean(False, doc="Whether that motion runs, or is halted.")

    pose_colors: param.Selector[str] = param.Selector(
        default="weights",
        objects=["weights", "plain", "materials"],
        doc="What the moving body's colours tell.",
    )
    materials: Any = param.Parameter(None, doc="(mesh, its `Textures` or None), or None so far.")
    rival: param.Selector[str] = param.Selector(
        default="alone",
        objects=["alone", "ghost", "beside"],
        doc="How the same motion with the file's own weights is seen.",
    )
    heat = param.Boolean(False, doc="Whether colours tell how far the two are apart.")
    errors: Any = param.Parameter(None, doc="(binding, DeformationError) about the scene's axes.")
    motion_error: Any = param.Parameter(
        None, doc="(binding, motion, mean and greatest cm² over it), once it is known."
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
        return f"clip {self.clip}" if self.clip >= 0 else f"swing {self.joint} {self.axis}"
