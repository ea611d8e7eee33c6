"""Everything that a person can choose on the page, and what was computed for it.

One object a browser session. It knows no widget and no layout.
"""

from __future__ import annotations

from typing import Any

import param

LAYERS = {
    "body": "body",
    "mesh_edges": "mesh edges",
    "interior_edges": "interior edges",
    "surface_edges": "surface edges",
    "skeleton": "bones",
}
"""The layers that can be switched, and the actor that each shows."""

MAX_UPLOAD = 200 * 1024 * 1024
"""The largest file that the page takes, in bytes."""


class State(param.Parameterized):
    """What the page shows."""

    demo: Any = param.String("", doc="Id of the demo character that was chosen; else empty.")
    rig: Any = param.Parameter(None, doc="The character: a cutcell.Rig, or None at first.")
    binding: Any = param.Parameter(None, doc="What was computed for it, or None so far.")
    field: Any = param.Parameter(None, doc="(binding, joint, distance at every graph node).")

    resolution: Any = param.Integer(64, doc="Lattice cells along the longest side.")

    body: Any = param.Boolean(True, label="Surface")
    mesh_edges: Any = param.Boolean(False, label="Mesh edges")
    interior_edges: Any = param.Boolean(False, label="Interior edges")
    surface_edges: Any = param.Boolean(False, label="Surface edges")
    skeleton: Any = param.Boolean(True, label="Skeleton")

    cut_axis: Any = param.Selector(default="off", objects=["off", "x", "y", "z"])
    cut_position: Any = param.Number(0.5, bounds=(0, 1))
    thin: Any = param.Boolean(True, doc="Show only a thin slice of the interior behind a cut.")

    coloring: Any = param.Selector(
        default="bones", objects=["bones", "weights", "distance", "plain"]
    )
    joint: Any = param.Integer(0, doc="The chosen joint.")

    axis: Any = param.Selector(default="z", objects=["x", "y", "z"], doc="What to turn about.")
    turns: Any = param.Dict({}, doc="Degrees about x, y and z, a triple for each turned joint.")
    clip: Any = param.Integer(-1, doc="Which clip of the rig to play; -1 swings the joint.")
    moving: Any = param.Boolean(False, doc="Whether a motion, rather than `turns`, poses.")
    playing: Any = param.Boolean(False, doc="Whether that motion runs, or is halted.")

    dark: Any = param.Boolean(False)

    busy: Any = param.Boolean(False, doc="Whether something is being computed.")
    stage: Any = param.String("", doc="What is being computed.")
    fraction: Any = param.Number(0.0, doc="How much of the stage is done, from 0 to 1.")
    message: Any = param.Parameter(None, doc="(severity, sentence) to show, or None.")

    @property
    def posed(self) -> bool:
        """Whether the character may be anywhere but at rest."""
        return self.moving or any(any(angles) for angles in self.turns.values())

    @property
    def weights(self) -> Any:
        """What the character is posed with: what was computed, else the file's own."""
        if self.binding is not None:
            return self.binding.weights
        return None if self.rig is None else self.rig.weights
