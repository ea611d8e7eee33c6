"""Tables of controls, and the function that draws them."""

from __future__ import annotations

import math
from collections.abc import Callable, Collection, Sequence
from operator import attrgetter
from typing import Any

from panel.viewable import Viewable

from ..document.session import Session
from ..document.state import State
from .follow import Follower, Followers


class Control:
    """Row of a table: a widget, what it shows of the state, and what it does.

    Parameters
    ----------
    kind : callable
        Class of the widget.
    name : str
        Parameter of the state that the widget shows and sets; empty for none.
    act : callable, optional
        Called with the session and the value that a person chooses, or the event of a button.
    content : sequence or callable
        Rows inside a group, or a function of the state that returns them.
    shows : callable, optional
        Function of the state that returns several options.
    late : collection of str
        See `Follower`.
    watched : str
        Parameter of the widget that changes when a person chooses.
    repeats : bool
        Whether Enter in a field chooses its text again that is the same.
    declared : callable, optional
        Function of the parameter that returns options of the widget besides its label.
    **options
        Options of the widget. A function is called with the state, again whenever what it reads
        changes, and returns the option's value.
    """

    def __init__(
        self,
        kind: Any,
        name: str = "",
        act: Callable[[Session, Any], Any] | None = None,
        content: Sequence[Any] | Callable[[Any], Sequence[Any]] = (),
        shows: Callable[[Any], dict[str, Any]] = lambda state: {},
        late: Collection[str] = (),
        watched: str = "value",
        repeats: bool = False,
        declared: Callable[[Any], dict[str, Any]] = lambda parameter: {},
        **options: Any,
    ) -> None:
        if name:
            options = {"value": attrgetter(name), **options}
            act = act or (lambda session, value: setattr(session.state, name, value))
        self.kind, self.act, self.content, self.watched = kind, act, content, watched
        self.late, self.repeats = frozenset(late), repeats
        self.fixed = {name: value for name, value in options.items() if not callable(value)}
        self._moving = {name: value for name, value in options.items() if callable(value)}
        self._name, self._declared, self._shows = name, declared, shows

    def declared(self, state: State) -> dict[str, Any]:
        """Return the options that the declaration of the parameter gives."""
        if not self._name:
            return {}
        parameter = state.param[self._name]
        return {"label": parameter.label, **self._declared(parameter)}

    def shown(self, state: State) -> dict[str, Any]:
        """Return the options that follow the state."""
        moving = {name: value(state) for name, value in self._moving.items()}
        return {**moving, **self._shows(state)}


def draw(session: Session, row: Any, panel: str = "") -> Any:
    """Return the widget of a row, which follows the state of a session from now on.

    A function of the session returns another row. `panel` is the one that the row is a part of.
    """
    return _draw(Followers(session, panel), row, None)


def _draw(followers: Followers, row: Any, owner: Follower | None) -> Any:
    if isinstance(row, Viewable):
        return row
    if not isinstance(row, Control):
        return _draw(followers, row(followers.session), owner)
    follower = Follower(row.shown, lambda values: _update(widget, values), row.late, owner)
    declared = row.declared(followers.session.state)
    options = {**declared, **row.fixed, **followers.add(follower)}
    rows = () if callable(row.content) else flat(row.content)
    widget = row.kind(*(_draw(followers, one, owner) for one in rows), **options)
    if callable(row.content):
        _follow_rows(followers, widget, row, owner)
    if row.act is not None:
        _connect(followers.session, widget, row)
    return widget


def _follow_rows(followers: Followers, group: Any, row: Any, owner: Follower | None) -> None:
    """Replace the rows of a group when the state changes."""

    def replace(rows: Sequence[Any]) -> None:
        followers.end_owned(follower)
        group.objects = [_draw(followers, one, follower) for one in flat(rows)]

    follower = Follower(row.content, replace, row.late, owner)
    replace(followers.add(follower))


def _connect(session: Session, widget: Any, row: Any) -> None:
    """Connect a widget to its parameter or action."""

    def chosen(event: Any) -> None:
        shown = {**row.fixed, **row.shown(session.state)}
        if event.new not in (None, shown["value"]):  # else nobody chose it
            row.act(session, event.new)

    if hasattr(widget, "on_click"):
        widget.on_click(lambda event: row.act(session, event))
    else:
        widget.param.watch(chosen, row.watched)

    def repeat(event: Any) -> None:
        # Enter comes before the new value of a text that was changed, which is chosen with that.
        if widget.value_input == widget.value:
            row.act(session, widget.value)

    if row.repeats:
        widget.param.watch(repeat, "enter_pressed")


def _update(widget: Any, values: dict[str, Any]) -> None:
    """Update a widget, but not by rounding: a person may have moved it meanwhile."""
    value = values.get("value")
    if isinstance(value, float) and math.isclose(value, widget.value, abs_tol=1e-6):
        values = {name: one for name, one in values.items() if name != "value"}
    widget.param.update(**values)


def flat(rows: Sequence[Any]) -> list[Any]:
    """Return rows, and those of tables among them, in one list."""
    return [one for row in rows for one in (flat(row) if isinstance(row, list | tuple) else [row])]
