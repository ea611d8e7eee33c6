"""What a person can choose on the panel Pose."""

from __future__ import annotations

from typing import Any

import param


class PoseChoices(param.Parameterized):
    """How the character stands, and what moves it."""

    axis: Any = param.Selector(default="z", objects=["x", "y", "z"], doc="What to turn about.")
    turns: Any = param.Dict({}, doc="Degrees about x, y and z, a triple for each turned joint.")
    clip: Any = param.Integer(-1, doc="Which clip of the rig to play; -1 swings the joint.")
    moving: Any = param.Boolean(False, doc="Whether a motion, rather than `turns`, poses.")
    playing: Any = param.Boolean(False, doc="Whether that motion runs, or is halted.")

    @property
    def posed(self) -> bool:
        """Whether the character is anywhere but at rest on the panels that pose it."""
        return self.moving or any(any(angles) for angles in self.turns.values())
