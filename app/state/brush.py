"""What a person can choose of the brush that paints weights."""

from __future__ import annotations

from typing import Any, get_args

import param

from cutcell.skinning.stroke import BrushMode

LEAST_RADIUS, MOST_RADIUS = 0.005, 0.5
"""Of the character's longest side."""
LEAST_STRENGTH = 0.05
PAINTED = ("weights", "pose")
"""The panels on which weights are painted: at rest, and posed."""


class BrushChoices(param.Parameterized):
    """Whether there is a brush, and what it does."""

    brush: Any = param.Boolean(False, label="Paint")
    brush_mode: Any = param.Selector(default="add", objects=list(get_args(BrushMode)))
    brush_radius: Any = param.Number(
        0.06, bounds=(LEAST_RADIUS, MOST_RADIUS), doc="Part of the character's longest side."
    )
    brush_strength: Any = param.Number(0.5, bounds=(LEAST_STRENGTH, 1))
    brush_value: Any = param.Number(1.0, bounds=(0, 1), doc="What weights are replaced by.")
    brush_mirrored: Any = param.Boolean(True, label="The other side, too")


BRUSH = frozenset(BrushChoices.param) - {"name"}
"""Tools are chosen, but are no choices: undo takes strokes back, not the brush."""
