"""The 3D view of the page: a scene's description, streamed to vtk.js in the browser."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import param
from numpy.typing import NDArray
from panel.custom import JSComponent
from panel.models.vtk import VTK_VERSION

from viewers.camera import Camera
from viewers.description import Actor, Apart, Description, Legend, Reading
from viewers.palette import Theme, colormap, to_hex
from viewers.scene import AMBIENT, LIGHTS
from viewers.skin import Skin

from .scripts import script
from .upload import Receiver


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
    _esm = script("orbit", "skin", "colour", "shade", "figure", "smooth", "stage", "fit", "room",
                  "pick", "surface", "gizmo", "transport", "upload", "keys", "connection", "names",
                  "overlay", "pointer", "film", "probe", "view")  # fmt: skip

    def __init__(
        self,
        on_pick: Callable[[int], None] | None = None,
        receiver: Receiver | None = None,
        **params: Any,
    ) -> None:
        super().__init__(**params)
        self._on_pick = on_pick
        self._receiver = receiver
        self.camera: Camera | None = None
        self.at_home = True
        self.on_camera: Callable[[], None] = lambda: None
        self.aspect = 4 / 3
        self.time = 0.0
        self._ready = False
        self._seen = False
        self._awaited: list[Callable[[], Any]] = []
        self._count = 0
        self._parts: dict[str, Any] = {}
        self._shown = Description()
        self._wanted = Description()
        self._sent: set[str] = set()
        self._listeners: dict[str, Callable[[dict[str, Any]], Any]] = {}

    def listen(self, kind: str, act: Callable[[dict[str, Any]], Any]) -> None:
        """Call a function with every message of a kind that the browser sends."""
        self._listeners[kind] = act

    def when_seen(self, act: Callable[[], Any]) -> None:
        """Do something once, as soon as a browser has the view, or says that it cannot show it."""
        self._awaited.append(act)
        if self._seen:
            self._begin()

    def present(self, description: Description) -> None:
        """Make the view what a description says."""
        self._wanted = description
        if self._ready:
            self._send(changes(self._shown, description, self._sent))
            self._shown = description

    def tell(self, **parts: Any) -> None:
        """Send the parts of the view that are no actors: see `theme_part` and its kin.

        The last value of each is kept, for a browser that comes later.
        """
        self._parts.update(parts)
        if self._ready:
            self._send(parts)

    def told(self, name: str) -> Any:
        """Return what was last told of a part of the view; None if nothing was."""
        return self._parts.get(name)

    def offer(self, name: str, content: bytes) -> None:
        """Let the browser save a file."""
        self._send_msg({"download": {"name": name, "content": content}})

    def answer(self, **message: Any) -> None:
        """Tell the browser what it asked for; it is not told again to one that comes later."""
        self._send_msg(message)

    def _send(self, message: dict[str, Any]) -> None:
        if message:
            self._count += 1
            self._send_msg({"id": self._count, **message})

    def _handle_msg(self, data: dict[str, Any]) -> None:
        kind = data.get("type")
        answer = None if self._receiver is None else self._receiver.answer(data)
        if answer is not None:
            self._send_msg({"upload": answer})
        if kind == "ready":
            self._ready = True
            self.dark = {"1": True, "0": False}.get(str(data.get("dark")))
            self.window_width = int(data.get("width", 0))
            self._sent.clear()
            first = {"lights": LIGHTS, **changes(Description(), self._wanted, self._sent)}
            self._send({**first, **self._parts})
            self._shown = self._wanted
            self._begin()
        elif kind == "cannot show":
            self._begin()
        elif kind == "pick" and self._on_pick is not None:
            self._on_pick(int(data["joint"]))
        elif kind in self._listeners:
            self._listeners[kind](data)
        elif kind == "time":
            self.time = float(data["time"])
        elif kind == "camera":
            self.camera = Camera(tuple(data["position"]), tuple(data["focal_point"]))
            self.aspect = min(max(float(data.get("aspect", self.aspect)), 0.3), 4.0)
            self.at_home = bool(data.get("home", False))
            self.on_camera()

    def _begin(self) -> None:
        self._seen = True
        awaited, self._awaited = self._awaited, []
        for act in awaited:
            act()


def changes(old: Description, new: Description, sent: set[str]) -> dict[str, Any]:
    """Return the message that turns one description into another.

    Parameters
    ----------
    old, new : Description
    sent : set of str
        Names of the actors that the browser has; brought up to date here. An actor is
        not sent before it is first seen.
    """
    message: dict[str, Any] = {}
    removed = [name for name in sent if name not in new.actors]
    actors: dict[str, Any] = {}
    for name, actor in new.actors.items():
        if name not in sent and not actor.visible:
            continue
        part = _part(old.actors.get(name) if name in sent else None, actor)
        if part:
            actors[name] = part
        sent.add(name)
    sent.difference_update(removed)
    if removed:
        message["remove"] = removed
    if actors:
        message["actors"] = actors
    if old.cut != new.cut:
        message["cut"] = new.cut and {"origin": new.cut.origin, "normal": new.cut.normal}
    if old.front != new.front:
        message["front"] = new.front
    if old.legend != new.legend:
        message["legend"] = _legend(new.legend)
    if old.views != new.views:
        message["views"] = list(new.views)
    if not _same(old.pose, new.pose):
        message["pose"] = None if new.pose is None else _flat(new.pose, np.float32)
    return message


def theme_part(theme: Theme) -> dict[str, str]:
    """Return how a theme is told to the view."""
    card = "rgba(255,255,255,.72)" if theme.name == "light" else "rgba(24,28,36,.72)"
    top, bottom, ink = to_hex(theme.top), to_hex(theme.bottom), to_hex(theme.ink)
    paper = "#ffffff" if theme.name == "light" else "#1b2028"
    return {"top": top, "bottom": bottom, "ink": ink, "card": card, "paper": paper}


def camera_part(camera: Camera) -> dict[str, Any]:
    """Return how a camera is told to the view."""
    return {"position": list(camera.position), "focal_point": list(camera.focal_point)}


def _part(old: Actor | None, new: Actor) -> dict[str, Any]:
    part: dict[str, Any] = {}
    if old is None or old.kind != new.kind:
        part["kind"] = new.kind
        old = None
    for name, dtype in (("points", np.float32), ("normals", np.float32), ("cells", np.uint32)):
        value = getattr(new, name)
        if value is not None and (old is None or not _same(getattr(old, name), value)):
            part[name] = _flat(value, dtype)
    if new.skin is not None and (old is None or not _same_skin(old, new)):
        part["skin"] = _skin(new.skin)
    if old is None or old.apart is not new.apart:
        part["apart"] = _apart(new.apart)
    part.update(_colouring(old, new))
    if (old is not None and old.film) != new.film:
        part["film"] = new.film
    if not _same_reading(None if old is None else old.reading, new.reading):
        part["reading"] = _reading(new.reading)
    for name, value in _settings(new).items():
        if old is None or _settings(old)[name] != value:
            part[name] = value
    if old is None or (old.clipped, old.slab) != (new.clipped, new.slab):
        part["clipped"], part["slab"] = new.clipped, new.slab
    return part


def _apart(apart: Apart | None) -> dict[str, Any] | None:
    if apart is None:
        return None
    return {**_skin(apart.skin), "unit": apart.unit}


def _skin(skin: Skin) -> dict[str, Any]:
    return {
        "joints": _flat(skin.joints, np.uint16),
        "weights": _flat(skin.weights, np.float32),
        "count": skin.joints.shape[1],
    }


def _colouring(old: Actor | None, new: Actor) -> dict[str, Any]:
    if new.colors is not None:
        if old is None or not _same(old.colors, new.colors):
            return {"colors": _flat(new.colors, np.uint8)}
        return {}
    if new.scalars is None:
        return {}
    same = old is not None and old.colors is None and _same(old.scalars, new.scalars)
    if same and old is not None and (old.colormap, old.limits) == (new.colormap, new.limits):
        return {}
    table = _flat(colormap(new.colormap), np.uint8)
    return {"scalars": _flat(new.scalars, np.float32), "table": table, "limits": new.limits}


def _settings(actor: Actor) -> dict[str, Any]:
    paint = {
        "color": actor.color,
        "opacity": actor.opacity,
        "width": actor.width,
        "ambient": AMBIENT,
        "behind": actor.behind,
        "closed": actor.closed and actor.opacity == 1,
        "hull": actor.hull,
        "coloured": actor.colors is not None or actor.scalars is not None,
    }
    place = {"overlay": actor.overlay, "view": actor.view}
    return {"paint": paint, "place": place, "visible": actor.visible}


def _reading(reading: Reading | None) -> dict[str, Any] | None:
    if reading is None:
        return None
    values = None if reading.values is None else _flat(reading.values, np.float32)
    return {"text": reading.text, "values": values, "names": list(reading.names)}


def _legend(legend: Legend | None) -> dict[str, Any] | None:
    if legend is None:
        return None
    table = _flat(colormap(legend.colormap), np.uint8) if legend.colormap else None
    swatches = [(to_hex(color), text) for color, text in legend.swatches]
    ends = {"low": legend.low, "high": legend.high}
    return {"title": legend.title, "table": table, "swatches": swatches, **ends}


def _flat(array: NDArray, dtype: Any) -> NDArray:
    return np.ascontiguousarray(array, dtype).ravel()


def _same(a: NDArray | None, b: NDArray | None) -> bool:
    if a is None or b is None:
        return a is b
    return a is b or (a.shape == b.shape and np.array_equal(a, b))


def _same_reading(old: Reading | None, new: Reading | None) -> bool:
    if old is None or new is None:
        return old is new
    same = (old.text, old.names) == (new.text, new.names)
    return same and _same(old.values, new.values)


def _same_skin(old: Actor, new: Actor) -> bool:
    if old.skin is None or new.skin is None:
        return old.skin is new.skin
    return _same(old.skin.joints, new.skin.joints) and _same(old.skin.weights, new.skin.weights)
