"""Choices of the panel Weights."""

from __future__ import annotations

from typing import Any

import param

from ...document.method import WEIGHTS, choices_of
from ...document.state import Panel
from ...editing.binding.bound import MOST

PANEL = Panel(
    "Weights",
    '<circle cx="12" cy="12" r="8.5"/><path d="M12 3.5v17M12 7.5h7M12 12h8.5M12 16.5h7"/>',
    paints=True,
)


class Choices(choices_of(WEIGHTS, max_influences=MOST)):  # type: ignore[misc]
    """Which weights are seen, and how they fall with distance."""

    weights_shown: param.Selector[str] = param.Selector(
        default="mix",
        objects=[
            "bone",
            "dominant",
            "mix",
            "count",
            "difference",
            "bone_difference",
            "symmetry",
            "mask",
            "selections",
        ],
    )
    weights_of: param.Selector[str] = param.Selector(
        default="ours",
        objects={"Current": "ours", "Original": "file"},
        doc="Weights that the colours show.",
    )
    truth: param.Selector[str] = param.Selector(
        default="file",
        objects={"Reference: file": "file", "Reference: computed": "ours"},
        doc="Weights that the others are measured against.",
    )

    weight_scale: param.Selector[str] = param.Selector(
        default="linear",
        objects={"Linear": "linear", "Log": "log", "Above limit": "limit"},
        doc="How colours show the weight of the chosen joint: one of `WEIGHT_SCALES`.",
    )
    weight_limit = param.Number(0.05, bounds=(0, 1), step=0.005, label="Limit")
    weight_outline = param.Boolean(True, label="Outline where not zero")

    explain = param.Boolean(
        False, doc="Whether the card says how the chosen vertex comes to its weights."
    )
    explanation: Any = param.Parameter(
        None, doc="What `cutcell.explain` returns for the chosen vertex, or None so far."
    )
