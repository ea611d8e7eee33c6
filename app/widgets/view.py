"""The 3D view of the page: a scene's description, streamed to vtk.js in the browser."""

from collections.abc import Callable, Mapping
from dataclasses import replace
from typing import Any, TypeVar, Unpack, cast

import param
from panel.custom import JSComponent
from panel.models.vtk import VTK_VERSION

from cutcell_viewers.camera import PAGE_HEIGHT, Camera
from cutcell_viewers.description import Description
from cutcell_viewers.lighting import LIGHTS

from ..files.receive import Receiver
from ..server.protocol.reading import read
from ..server.protocol.received import CameraMoved, Message, Ready, Time
from ..server.protocol.sent import Painted, ToBrowser
from .changes import changes, painted, repainted
from .modules import script

ACTORS = frozenset({"actors", "images", "bones", "pose", "clip"})
"""Parts of a scene that a browser needs only where it draws them itself."""


M = TypeVar("M", bound=Message)


class SceneView(JSComponent):
    """Shows a `Description`, and tells what a person does with it.

    Only what changed since the last time is sent. Nothing is sent before the browser says
    that it is ready; then it gets everything.
    """

    vtk_url = param.String(
        f"static/extensions/panel/bundled/abstractvtkplot/vtk.js@{VTK_VERSION}/vtk.js",
        constant=True,
        doc="Where Panel's own server keeps vtk.js.",
    )

    dark = param.Boolean(None, allow_None=True, doc="The theme this browser had last time.")

    window_width = param.Integer(0, doc="Width of the browser's window, once it is known.")

    _rename = {"window_width": None, "dark": None}  # noqa: RUF012
    _esm = script("view/view")

    def __init__(self, **params: Any) -> None:
        super().__init__(**params)
        self.receiver: Receiver | None = None
        self.camera: Camera | None = None
        self.at_home = True
        self.on_camera: Callable[[], None] = lambda: None
        self.aspect, self.page_height = 4 / 3, PAGE_HEIGHT
        self.time = 0.0
        self.calm = False
        self.page_before = ""
        self._ready = False
        self._is_visible = False
        self._pictures = False
        self._awaited: list[Callable[[], Any]] = []
        self._count = 0
        self._parts: dict[str, Any] = {}
        self._sent = Description()
        self._next = Description()
        self._sent_arrays: set[str] = set()
        self._listeners: dict[type[Message], Callable[[Any], Any]] = {}

    def listen(self, kind: type[M], act: Callable[[M], Any]) -> None:
        """Call a function with every message of a kind that the browser sends."""
        self._listeners[kind] = act

    def when_seen(self, act: Callable[[], Any]) -> None:
        """Do something once, as soon as a browser has the view."""
        self._awaited.append(act)
        if self._is_visible:
            self._begin()

    def present(self, description: Description, **parts: Any) -> None:
        """Show a description, and parts of the view that belong to it, in one message."""
        self._next = description
        self._parts.update(parts)
        if self._ready:
            self._send({**changes(self._sent, description, self._sent_arrays), **parts})
            self._sent = description

    def send(self, **parts: Unpack[ToBrowser]) -> None:
        """Send the parts of the view that are no actors: see `shell/session/view_parts.py`.

        The last value of each is kept, for a browser that comes later.
        """
        self._parts.update(parts)
        if self._ready:
            self._send(parts)

    def last_sent(self, name: str) -> Any:
        """Return the last value sent for a part of the view; None if none was."""
        return self._parts.get(name)

    def offer(self, name: str, content: bytes) -> None:
        """Send a file to the browser, which saves it."""
        self._send_msg({"download": {"name": name, "content": content}})

    def answer(self, **message: Unpack[ToBrowser]) -> None:
        """Answer a request of the browser; the answer is not sent again to a new one.

        Of points that are painted, those that the browser shows already are left out.
        """
        body = self._sent.actors.get("body")
        rows = message.get("painted")
        if rows is not None and "vertices" in rows and body is not None:
            after = painted(body, rows) if len(rows["vertices"]) else body
            self._sent = replace(self._sent, actors={**self._sent.actors, "body": after})
            message["painted"] = cast(Painted, repainted(body, after)[0])
        self._send_msg(message)

    def _send(self, message: Mapping[str, Any]) -> None:
        if not message:
            return
        if self._pictures:
            message = {name: part for name, part in message.items() if name not in ACTORS}
        self._count += 1
        self._send_msg({"id": self._count, **message})

    def _handle_msg(self, data: dict[str, Any]) -> None:
        answer = None if self.receiver is None else self.receiver.answer(data)
        if answer is not None:
            self._send_msg({"upload": answer})
            return
        match read(data):
            case Ready() as ready:
                self._begin_anew(ready)
            case Time(time):
                self.time = time
            case CameraMoved() as moved:
                self._look(moved)
            case message if type(message) in self._listeners:
                self._listeners[type(message)](message)

    def _begin_anew(self, ready: Ready) -> None:
        """Send everything to a browser that has just come."""
        self._ready = True
        self.dark = {"1": True, "0": False}.get(str(ready.dark))
        self.calm, self._pictures = ready.calm, ready.pictures
        self.window_width = ready.width
        self.page_before = ready.page or ""
        self._sent_arrays.clear()
        first = {"lights": LIGHTS, **changes(Description(), self._next, self._sent_arrays)}
        self._send({**first, **self._parts})
        self._sent = self._next
        self._begin()

    def _look(self, moved: CameraMoved) -> None:
        self.camera = Camera(moved.position, moved.focal_point)
        self.aspect = min(max(moved.aspect or self.aspect, 0.3), 4.0)
        self.page_height = min(max(moved.height or self.page_height, 100.0), 4000.0)
        self.at_home = moved.home
        self.on_camera()

    def _begin(self) -> None:
        self._is_visible = True
        awaited, self._awaited = self._awaited, []
        for act in awaited:
            act()
