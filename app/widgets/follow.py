"""Widgets that are updated whenever what they show of the state changes."""

from __future__ import annotations

from collections.abc import Callable, Set
from dataclasses import dataclass
from functools import cache, partial
from typing import Any

from panel.io import hold

from ..derive.engine import WIDGETS
from ..derive.reading import view_of
from ..document.session import Session
from ..document.state import State


@cache
def names_of(kind: type[State]) -> frozenset[str]:
    """Return the names of all parameters of a class of states."""
    return frozenset(kind.param)


@dataclass(eq=False)
class Follower:
    """A function of the state, what is done with its value, and the names that it read last.

    Changes of parameters in `late` are followed only after a pause: the view comes first. When its
    owner runs again, it ends.
    """

    function: Callable[[Any], Any]
    act: Callable[[Any], Any]
    late: Set[str] = frozenset()
    owner: Follower | None = None
    names: Set[str] = frozenset()

    def is_owned_by(self, other: Follower) -> bool:
        """Return whether this one ends when another one runs."""
        return self.owner is not None and (self.owner is other or self.owner.is_owned_by(other))


class Followers:
    """Followers that send all that they change in one message.

    Those of a panel wait while another one is shown.
    """

    def __init__(self, session: Session, panel: str = "") -> None:
        self.session, self._panel = session, panel
        self._all: list[Follower] = []
        self._missed: Set[str] = frozenset()
        self._names = names_of(type(session.state))
        session.engine.follow(self._changed, WIDGETS)

    def add(self, one: Follower) -> Any:
        """Add a follower, and return its function's value; it has not acted yet."""
        self._all.append(one)
        return self._read(one)

    def end_owned(self, owner: Follower) -> None:
        """End all followers that one owns."""
        self._all = [one for one in self._all if not one.is_owned_by(owner)]

    def _read(self, one: Follower) -> Any:
        view = view_of(self.session.state)
        value = one.function(view)
        one.names = view.read_names
        return value

    def _run(self, one: Follower) -> None:
        if one in self._all:
            one.act(self._read(one))

    def _changed(self, names: Set[str], is_reset: bool) -> None:
        # A parameter is triggered where nothing came of a choice: every widget is reset.
        names = self._names if is_reset else self._missed | names
        is_seen = self._panel in ("", self.session.state.panel)
        self._missed = frozenset() if is_seen else names
        if not is_seen:
            return
        with hold():
            for one in [*self._all]:
                changed = names & one.names
                if changed and changed <= one.late:
                    self.session.work.after_a_pause(partial(self._run, one), str(id(one)))
                elif changed:
                    self._run(one)
