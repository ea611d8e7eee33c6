"""Choices of the brush that paints weights."""

from __future__ import annotations

from typing import Any, get_args

import param

from ..compute.stroke import BrushMode

MIN_RADIUS, MAX_RADIUS = 0.005, 0.5
"""Radius of the brush, relative to the character's longest side."""
MIN_STRENGTH = 0.05


class Choices(param.Parameterized):
    """Whether there is a brush, and what it does."""

    brush = param.Boolean(False, label="Paint")
    brush_mode: param.Selector[str] = param.Selector(
        default="add",
        objects={mode.capitalize(): mode for mode in (*get_args(BrushMode), "select", "mask")},
    )
    brush_radius = param.Number(
        0.06, bounds=(MIN_RADIUS, MAX_RADIUS), step=0.005, label="Radius (% of size)",
        doc="Part of the character's longest side.",
    )  # fmt: skip
    brush_strength = param.Number(0.5, bounds=(MIN_STRENGTH, 1), step=0.05, label="Strength")
    brush_value = param.Number(1.0, bounds=(0, 1), step=0.05, label="Weight to paint")
    brush_mirrored = param.Boolean(False, label="Mirror")
    brush_selection: Any = param.Parameter(
        None, doc="The `Selection` that strokes are limited to, of whatever mesh; or None."
    )


TOOLS = frozenset(Choices.param) - {"name"}
"""Tools are chosen, but are no choices: undo takes strokes back, not the brush."""
