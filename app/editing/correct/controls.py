"""All edits: how many there are; save them, open others, remove all."""

from typing import Any

import panel_material_ui as pmui

from cutcell.runtime.display import count

from ...document.session import Session
from ...document.state import State
from ...widgets import controls as ui
from . import commands as correct

MAX_FILE = 4 * 2**20
NONE = "No edits yet. They are included in the export and can be saved as JSON."


def summary(state: State) -> str:
    """Say how much is edited."""
    edits = state.edits
    numbers = [(len(edits.joints), "joint"), (len(edits.layers), "layer")]
    parts = [count(number, one) for number, one in numbers if number]
    return f"Edited: {', '.join(parts)}. Included in the export." if parts else NONE


def _opener(session: Session) -> pmui.FileInput:
    """Return the button that opens a file of edits."""

    def opened(event: Any) -> None:
        if event.new is not None:
            opener.value = None  # the same file may be opened again
            correct.open_text(session, event.new.decode(errors="replace"))

    opener = pmui.FileInput(
        label="Open",
        uploaded_label="Open",
        accept=".json",
        icon="folder_open",
        max_file_size=MAX_FILE,
        variant="outlined",
        sx={"&:focus-within": {"outline": "2px solid #e05a00", "outlineOffset": "1px"}},
        **{**ui.SMALL, "margin": ui.BESIDE},
    )
    opener.param.watch(opened, "value")
    return opener


def _button(label: str, act: Any) -> Any:
    return ui.button(label, act, margin=ui.BESIDE, disabled=lambda state: not state.edits)


EDITS = ui.folded(
    "Edits",
    ui.caption(summary),
    ui.row(_button("Save", correct.save), _opener, _button("Clear all", correct.clear)),
)
