"""Choices of the tools that select vertices and change their weights."""

from __future__ import annotations

from typing import Any

import param


class Choices(param.Parameterized):
    """How vertices are selected, and what is done with them."""

    lasso = param.Boolean(False, label="Lasso")
    lasso_through = param.Boolean(False, label="Lasso hidden vertices")
    isolated = param.Boolean(False, label="Isolate")
    condition = param.String("", doc="The condition that was applied last.")
    saved = param.String("", doc="The saved selection that was chosen or saved last.")
    amount = param.Number(0.1, bounds=(0, 1), step=0.01, label="Amount")
    move_from = param.String("", doc="The joint whose weight is moved; empty for all.")
    passes = param.Integer(5, bounds=(1, 50), label="Smoothing passes")
    other_bone = param.String("", doc="The joint that the chosen one is swapped with, or empty.")
    bone_table = param.String("", doc="The table of bones that was applied last.")
    with_children = param.Boolean(False, label="With all bones below")
    copied: Any = param.Parameter(None, doc="Points (s, 3) and rows (s, j) that were copied.")
    copied_mask: Any = param.Parameter(None, doc="A mesh, and strengths (n,) that were copied.")
    table = param.Boolean(False, label="Table")
    table_order: Any = param.Parameter(
        (None, True), doc="What sorts the table (None: the chosen joint), and whether descending."
    )
    table_page = param.Integer(0)
    histogram = param.Boolean(False, label="Histogram")
    bars: Any = param.Parameter(
        None, doc="First and last bar of the histogram that are chosen, or None."
    )


TOOLS = frozenset(Choices.param) - {"name"}
"""Tools, which are no choices of a scene: neither undo nor the address has them."""
