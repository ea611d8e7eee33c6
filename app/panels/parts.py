"""What the sections of the sidebar have in common."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import panel as pn
import panel_material_ui as pmui

GAP = (4, 0)
"""Space above and below a widget, and beside it."""


def section(title: str, *objects: Any) -> pmui.Column:
    """Return a titled section of the sidebar."""
    heading = pmui.Typography(
        title,
        variant="overline",
        margin=(0, 0, 2, 0),
        sx={"fontWeight": 600, "letterSpacing": "0.08em", "color": "text.secondary"},
    )
    return pmui.Column(heading, *objects, margin=(14, 20, 4, 20), sizing_mode="stretch_width")


def caption(text: Any = "", **params: Any) -> pmui.Typography:
    """Return a line of small, quiet text."""
    look = {"color": "text.secondary", "lineHeight": 1.45, "display": "block"}
    params = {"margin": (2, 0, 6, 0), "sizing_mode": "stretch_width", **params}
    return pmui.Typography(text, variant="caption", sx=look, **params)


def when(function: Callable[..., Any], *parameters: Any) -> Any:
    """Return a value that follows parameters: `function` of theirs, ever again."""
    return pn.bind(function, *parameters)


def choice(parameter: Any, options: dict[str, Any], **params: Any) -> pmui.RadioButtonGroup:
    """Return a row of buttons, one of which is pressed."""
    return pmui.RadioButtonGroup.from_param(
        parameter,
        options=options,
        label="",
        size="small",
        margin=GAP,
        sizing_mode="stretch_width",
        sx={"width": "100%", "& .MuiToggleButton-root": {"flex": 1, "py": "5px"}},
        **params,
    )
