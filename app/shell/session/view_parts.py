"""What the view shows of the state: the scene, handles, bones, motions; sent when it changes."""

from collections.abc import Callable, Mapping, Set
from functools import partial
from typing import Any

import numpy as np

from cutcell.runtime.progress import Progress, silent

from ...derive.engine import VIEW
from ...derive.jobs import DESCRIBING
from ...derive.reading import Recorded
from ...document.framing import bones_part, theme_of, theme_part
from ...document.session import Session
from ...document.state import State
from ...features import FEATURES
from ...features.scenes import resolve
from ...server.protocol.received import MovePoint

SCENE = "scene"
HANDLES = {name: one for feature in FEATURES.values() for name, one in feature.handles.items()}


def _points(state: State) -> dict[str, list[float]] | None:
    """Return the points that can be dragged, by their names; None for none."""
    places = {name: one.at(state) for name, one in HANDLES.items()}
    return {n: [float(x) for x in at] for n, at in places.items() if at is not None} or None


PARTS: dict[str, Callable[[State], Any]] = {
    "bones": bones_part,
    "points": _points,
    "theme": lambda state: theme_part(theme_of(state)),
    "rendered": lambda state: state.rendered,
}
"""By the name in messages: a function that returns the part, or None for none."""
for one in FEATURES.values():
    PARTS |= one.parts


def watch(session: Session) -> None:
    """Show the state from now on, and move what is dragged."""

    def move(message: MovePoint) -> None:
        if message.name in HANDLES:
            HANDLES[message.name].move(session, message.position, message.done)

    session.view.listen(MovePoint, move)
    Shown(session).update()


class Shown:
    """What the view of a session shows.

    A scene arrives together with the parts that were read of the same state: handles and bones of
    another character than the one in sight would be picked. The scene of a large character is
    described in another thread.
    """

    def __init__(self, session: Session) -> None:
        self._session = session
        makers = {SCENE: lambda state: resolve(state), **PARTS}
        self._cells = {name: Recorded(partial(_made, make)) for name, make in makers.items()}
        self._meanwhile: set[str] = set()
        session.engine.follow(self._changed, VIEW)

    def _changed(self, names: Set[str], is_reset: bool) -> None:
        self._meanwhile |= names
        for cell in self._cells.values():
            cell.forget(names)
        self.update()

    def update(self) -> None:
        """Show what has changed, now or when it is described."""
        state, work = self._session.state, self._session.work
        stale = {name: cell for name, cell in self._cells.items() if cell.is_stale}
        if state.quick or SCENE not in stale:
            work.cancel(SCENE)
            self._show({name: cell.read(state) for name, cell in stale.items()})
        elif not work.is_running(SCENE):
            copy = state.snapshot()
            fresh = {name: cell.renewed() for name, cell in stale.items()}
            self._meanwhile = set()

            def describe(progress: Progress) -> dict[str, Any]:
                return {name: cell.read(copy) for name, cell in fresh.items()}

            def show(values: dict[str, Any]) -> None:
                self._take(fresh)
                self._show(values)
                self.update()

            work.start(SCENE, describe, show, slots=DESCRIBING, report=silent)

    def _take(self, cells: Mapping[str, Recorded[Any]]) -> None:
        """Replace cells by those that were read in another thread, which may be stale by now."""
        self._cells.update(cells)
        for cell in cells.values():
            cell.forget(self._meanwhile)

    def _show(self, values: dict[str, Any]) -> None:
        """Send what differs from what the view has, and report what could not be made."""
        session, view = self._session, self._session.view
        errors = [one for one in values.values() if isinstance(one, Exception)]
        values = {n: None if isinstance(one, Exception) else one for n, one in values.items()}
        scene = values.pop(SCENE, None)
        parts = {n: part for n, part in values.items() if not _is_same(part, view.last_sent(n))}
        if scene is not None:
            view.present(scene, **parts)
        elif parts:
            view.send(**parts)
        for error in errors:
            session.fail(error)


def _made(make: Callable[[State], Any], state: State) -> Any:
    """Return a part, or the error for which there is none: the page must hear of it."""
    try:
        return make(state)
    except Exception as error:
        return error


def _is_same(one: Any, other: Any) -> bool:
    if one is other:
        return True
    if isinstance(one, dict) and isinstance(other, dict):
        return one.keys() == other.keys() and all(_is_same(one[key], other[key]) for key in one)
    return type(one) is type(other) and bool(np.array_equal(one, other))
