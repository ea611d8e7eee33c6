"""Actions of the keys that select vertices and change their weights."""

from collections.abc import Callable

from ...document.session import Session
from ..brush.strokes import clear_selection
from .operations import OPERATIONS, copy, move, paste, smooth
from .selections import can_select, grow, isolate, select_all, shrink, take_lasso

ACTS: dict[str, Callable[[Session], None]] = {
    "lasso": take_lasso,
    "isolate": isolate,
    "select all": select_all,
    "select none": clear_selection,
    "grow": grow,
    "shrink": shrink,
    "move weight": move,
    "fill": OPERATIONS["Fill with amount"],
    "smooth": smooth,
    "copy": copy,
    "paste": paste,
}
"""By their names in `frontend/page/keys.js`."""


def act(session: Session, name: str) -> None:
    """Do what a key says, where weights are in sight."""
    if name in ACTS and can_select(session.state):
        ACTS[name](session)
