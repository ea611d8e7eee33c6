"""Choices of the panel Weights."""

from __future__ import annotations

from typing import Any

import param

from cutcell.method import FALLOFFS, REFINES

from .method import default

MOST = 8
"""Influences that a vertex is measured for, and the most that can be chosen."""

SHOWN = ("bone", "dominant", "mix", "count", "difference", "bone_difference")

SIDES = ("ours", "file")
"""Whose weights: those that were computed, or the file's own."""


class WeightsChoices(param.Parameterized):
    """Which weights are seen, and how they fall with distance."""

    weights_shown: param.Selector[str] = param.Selector(default="mix", objects=list(SHOWN))
    weights_of: param.Selector[str] = param.Selector(
        default="ours", objects=list(SIDES), doc="Whose weights the colours tell."
    )
    truth: param.Selector[str] = param.Selector(
        default="file", objects=list(SIDES), doc="What the other side is measured against."
    )

    explain = param.Boolean(
        False, doc="Whether the card says how the chosen vertex comes to its weights."
    )
    explanation: Any = param.Parameter(
        None, doc="The binding, and what `cutcell.explain` says of a vertex of it; or None so far."
    )

    falloff: param.Selector[str] = param.Selector(
        default=default("falloff"), objects=list(FALLOFFS)
    )
    refine: param.Selector[str] = param.Selector(default=default("refine"), objects=list(REFINES))
    alpha = param.Number(default("alpha"), bounds=(0, 1))
    max_influences = param.Integer(default("max_influences"), bounds=(1, MOST))
    threshold = param.Number(default("threshold"), bounds=(0, 1))
