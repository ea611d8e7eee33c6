"""The address, undo and reset, and what the keys do."""

from __future__ import annotations

import time
from typing import TYPE_CHECKING, Any

from ..choices import NOTED, defaults, simple, taken, to_query
from ..history import History
from ..scenes.common import first_joint

if TYPE_CHECKING:
    from ..session import Session


def watch(session: Session) -> None:
    """Keep the address and the history up to what is chosen; obey the keys."""
    habits = Habits(session)
    session.habits = habits
    names = [*simple(session.state), *NOTED]
    session.state.param.watch(habits.chose, names)
    session.state.param.watch(habits.begin, "rig")
    session.state.param.watch(habits.looked, ["tour", "vertex"])
    session.view.listen("act", habits.act)
    session.view.on_camera = habits.looked


class Habits:
    """What a person does on any panel."""

    def __init__(self, session: Session) -> None:
        self._session = session
        self._history = History({})
        self._going = False
        self._said = ""

    def begin(self, *events: Any) -> None:
        """Begin anew, with a new character."""
        self._history = History(taken(self._session.state))
        self._tell()

    def chose(self, *events: Any) -> None:
        """Note a choice."""
        session = self._session
        if session.state.rig is None or self._going:
            return
        self._history.note(taken(session.state), time.monotonic())
        self._tell()

    def withdraw(self, choices: dict[str, Any]) -> None:
        """Choose something again in place of what cannot be; nobody goes back to that."""
        self._choose(choices)
        self._history.withdraw(taken(self._session.state))
        self._tell()

    def looked(self, *events: Any) -> None:
        """Note that the camera moved, or the tour went on, or a vertex was clicked."""
        self._tell()

    def query(self) -> str:
        """Return what the address says now."""
        session = self._session
        view = session.view
        camera = None
        if view.camera is not None and not view.at_home:
            camera = [*view.camera.position, *view.camera.focal_point]
        return to_query(session.state, session.opening.kept, camera)

    def _tell(self) -> None:
        state = self._session.state
        if state.rig is None:
            return
        said = self.query()
        able = [self._history.can_undo, self._history.can_redo]
        if (said, able) != self._said:
            self._said = (said, able)  # type: ignore[assignment]
            self._session.view.tell(address="?" + said, able=able)

    # What keys and buttons ask for

    def act(self, message: dict[str, Any]) -> None:
        """Do what a key or a button says."""
        does = {
            "undo": self.undo,
            "redo": self.redo,
            "reset": self.reset,
            "play": self.play,
            "next": lambda: self.step(1),
            "previous": lambda: self.step(-1),
            "parent": self.parent,
            "child": self.child,
        }.get(str(message.get("act")))
        if does is not None and self._session.state.rig is not None:
            does()

    def undo(self) -> None:
        """Go back to what was chosen before."""
        self._go(self._history.undo())

    def redo(self) -> None:
        """Choose again what was undone."""
        self._go(self._history.redo())

    def reset(self) -> None:
        """Choose what one begins with, at rest, on the panel that is open."""
        session = self._session
        state = session.state
        first = {**defaults(state), "moving": False, "playing": False}
        state.param.update(**first, joint=first_joint(state.rig))
        session.view.tell(home=True)

    def play(self) -> None:
        """Play the motion, or halt it; on the panel where things move."""
        state = self._session.state
        if state.bare:
            return
        if not state.moving or state.panel not in ("pose", "compare"):
            panel = state.panel if state.panel == "compare" else "pose"
            state.param.update(panel=panel, moving=True, playing=True)
        else:
            state.playing = not state.playing

    def step(self, count: int) -> None:
        """Choose the next joint of the list, or the one before."""
        state = self._session.state
        if state.bare:
            return
        state.joint = (state.joint + count) % len(state.rig.skeleton.names)

    def parent(self) -> None:
        """Choose the joint that the chosen one hangs on."""
        state = self._session.state
        if state.bare:
            return
        above = int(state.rig.skeleton.parents[state.joint])
        if above >= 0:
            state.joint = above

    def child(self) -> None:
        """Choose the first joint that hangs on the chosen one."""
        state = self._session.state
        if state.bare:
            return
        below = state.rig.skeleton.children[state.joint]
        if len(below):
            state.joint = int(below[0])

    def _go(self, choices: dict[str, Any] | None) -> None:
        if choices:
            self._choose(choices)
            self._tell()

    def _choose(self, choices: dict[str, Any]) -> None:
        self._going = True
        try:
            self._session.state.param.update(**choices)
        finally:
            self._going = False
