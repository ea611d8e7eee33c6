"""Selections that are saved by name: they are part of the edits."""

from dataclasses import replace

import numpy as np

from cutcell.editing import Mask
from cutcell.errors import ParameterError

from ...document.selection import selected, selected_vertices
from ...document.session import Session
from ...document.state import State
from ...looks.mask import masked
from ...widgets import controls as ui
from ..brush.strokes import select
from ..correct.commands import correct

NONE = "None"


def save(session: Session, name: str) -> None:
    """Save the selection by a name, in place of one that has it already."""
    state, name = session.state, name.strip()
    if not name:
        return
    if selected(state) is None:
        session.fail(ParameterError("no vertices are selected; select some to save them"))
        return
    session.history.part()
    mask = Mask(vertices=selected_vertices(state))
    correct(session, replace(state.edits, selections={**state.edits.selections, name: mask}))
    state.saved = name


def take(session: Session, name: str) -> None:
    """Select the vertices of a saved selection."""
    state = session.state
    state.saved = name if name in state.edits.selections else ""
    if state.saved:
        chosen = np.zeros(len(state.rig.mesh.vertices), np.bool_)
        which = masked(state.edits.selections[name], state.rig.mesh)
        chosen[slice(None) if which is None else which] = True
        select(session, chosen)


def forget(session: Session) -> None:
    """Delete the saved selection that was chosen."""
    edits, name = session.state.edits, session.state.saved
    rest = {key: mask for key, mask in edits.selections.items() if key != name}
    session.history.part()
    correct(session, replace(edits, selections=rest))


def _names(state: State) -> list[str]:
    return [NONE, *state.edits.selections]


def _place(state: State) -> int:
    return _names(state).index(state.saved) if state.saved in state.edits.selections else 0


def _has_any(state: State) -> bool:
    return bool(state.edits.selections)


SAVED = ui.column(
    ui.text_box(
        "Save selection as",
        act=save,
        value=lambda state: state.saved,
        repeats=True,
        visible=lambda state: selected(state) is not None,
    ),
    ui.pick(
        "Saved selection",
        _names,
        _place,
        lambda session, place: take(session, _names(session.state)[place] if place else ""),
        visible=_has_any,
        margin=(10, 0, 4, 0),
    ),
    ui.button(
        "Delete saved selection", forget, icon="delete",
        visible=_has_any, disabled=lambda state: state.saved not in state.edits.selections,
    ),
)  # fmt: skip
