"""The lasso in the view, and the keys that select vertices and change their weights."""

from collections.abc import Callable
from functools import partial
from typing import Any

from ...document.session import Session
from ..brush.strokes import clear_selection
from .operations import OPERATIONS, copy, move, paste, smooth
from .selections import (
    can_select,
    grow,
    isolate,
    lasso_part,
    select_all,
    shrink,
    take_lasso,
    watch,
)

__all__ = ["KEYS", "PARTS", "watch"]


def _where_possible(action: Callable[[Session], Any], session: Session) -> None:
    """Act where weights are in sight."""
    if can_select(session.state):
        action(session)


PARTS = {"lasso": lasso_part}
_ACTIONS: dict[str, Callable[[Session], Any]] = {
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
KEYS = {name: partial(_where_possible, action) for name, action in _ACTIONS.items()}
