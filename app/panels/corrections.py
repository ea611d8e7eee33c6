"""All corrections: how many there are; save them, open others, take all back."""

from __future__ import annotations

from typing import Any

import panel_material_ui as pmui

from cutcell.diagnosis.finding import count
from cutcell.editing.corrections import Corrections

from ..commands import correct
from ..commands.session import Session
from ..widgets.open_file import OpenFile
from .controls import caption, section, when

NONE = "No corrections yet. They are included in the export and can be saved as JSON."


def corrections(session: Session) -> pmui.Column:
    """Return the section that saves corrections and opens them."""
    state = session.state
    none = when(lambda corrections: not corrections, state.param.corrections)
    buttons = [
        pmui.Button(
            label=label,
            size="small",
            variant="outlined",
            margin=(4, 8, 4, 0),
            sizing_mode="stretch_width",
            disabled=none,
            on_click=lambda event, act=act: act(session),
        )
        for label, act in (("Save", correct.save), ("Clear all", correct.clear))
    ]
    opener = OpenFile(
        lambda text: correct.open_text(session, text),
        label="Open",
        accept=".json",
        margin=(4, 8, 4, 0),
        sizing_mode="stretch_width",
    )
    return section(
        "Corrections",
        caption(when(summary, state.param.corrections)),
        pmui.Row(buttons[0], opener, buttons[1], margin=0, sizing_mode="stretch_width"),
    )


def summary(corrections: Corrections) -> str:
    """Say how much is corrected."""
    numbers: list[tuple[Any, str]] = [
        (corrections.joints, "joint"), (corrections.parts, "part"),
        (corrections.vertices, "vertex"),
    ]  # fmt: skip
    parts = [count(len(which), one) for which, one in numbers if which]
    if not parts:
        return NONE
    return f"Corrected: {', '.join(parts)}. Included in the export."
