"""Scenes of a session without a browser, recorded for a page without a server."""

from __future__ import annotations

import queue
from collections.abc import Callable
from typing import Any

from cutcell.errors import CutcellError
from cutcell_viewers.description import Description

from ..shell.session.begin import begin
from ..widgets.changes import changes

PARTS = ("animation", "bones", "brush", "camera", "clip", "front", "gizmo", "images", "playing")
"""Parts of the view that are recorded besides its scene."""


class Recorder:
    """A session, and the thread that owns it."""

    def __init__(self) -> None:
        self._actions: queue.Queue[Callable[[], Any]] = queue.Queue()
        self.session = begin(self._actions.put)
        self._view: Any = self.session.view

    def close(self) -> None:
        """End the session."""
        self.session.close()

    def rest(self) -> None:
        """Run until no work is left; raise a `CutcellError` where something failed."""
        work, is_idle = self.session.work, False

        def end() -> None:
            nonlocal is_idle
            if work.busy:  # scheduled actions have begun more
                work.when_idle(end)
            else:
                is_idle = True

        work.when_idle(end)
        while not is_idle:
            self._actions.get()()
        severity, text = self.session.state.message or ("", "")
        if severity == "error":
            raise CutcellError(text)

    @property
    def description(self) -> Description:
        """The scene that is shown."""
        description: Description = self._view._next
        return description

    def message(self) -> dict[str, Any]:
        """Return the message that shows the current view in an empty one."""
        self.rest()
        sent = self._view._parts
        parts = {name: sent[name] for name in PARTS if sent.get(name) is not None}
        return {**parts, **changes(Description(), self.description, set())}
