"""All corrections: how many there are; save them, open others, take all back."""

from typing import Any

import panel_material_ui as pmui

from cutcell.editing.corrections import Corrections
from cutcell.runtime.display import count

from ..commands import correct
from ..commands.session import Session
from .controls import BESIDE, CONTROL, button, caption, folded, row, when

MAX_FILE = 4 * 2**20
NONE = "No corrections yet. They are included in the export and can be saved as JSON."


def corrections(session: Session) -> pmui.Column:
    """Return the section that saves corrections and opens them."""
    state = session.state
    none = when(lambda held: not held, state.param.corrections)
    style = {"margin": BESIDE, "disabled": none}
    opener = pmui.FileInput(
        label="Open",
        uploaded_label="Open",
        accept=".json",
        icon="folder_open",
        max_file_size=MAX_FILE,
        variant="outlined",
        sx={"&:focus-within": {"outline": "2px solid #e05a00", "outlineOffset": "1px"}},
        **{**CONTROL, "margin": BESIDE},
    )

    def opened(event: Any) -> None:
        if event.new is not None:
            opener.value = None  # the same file may be opened again
            correct.open_text(session, event.new.decode(errors="replace"))

    opener.param.watch(opened, "value")
    return folded(
        "Corrections",
        caption(when(summary, state.param.corrections)),
        row(
            button("Save", lambda: correct.save(session), **style),
            opener,
            button("Clear all", lambda: correct.clear(session), **style),
        ),
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
