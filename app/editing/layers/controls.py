"""The stack of layers: what lies below it, a list, and the chosen layer."""

from typing import Any, get_args

import numpy as np

from cutcell.editing import Attached, Computed, Layer, Locked, Mirrored, Painted, Smoothed
from cutcell.editing.layers.contents import Content
from cutcell.editing.layers.layer import Mode
from cutcell.runtime.display import count, listed

from ...document.selection import selected
from ...document.session import Session
from ...document.state import State
from ...looks.mask import chosen_layer as _layer
from ...widgets import controls as ui
from ...widgets.rows import Rows
from ..compute import stack
from . import commands
from .masks import MASKS

ABOUT = (
    "Layers change the weights below them. Strokes go into the chosen painted layer, as far as its "
    "mask lets them, or a new one."
)
NEW = "A new layer covers the selection, or else everything."
LATE = ("binding",)


def _rows(state: State) -> dict[str, Any]:
    """Return the rows of the list, the topmost layer first, and the chosen one."""
    layers = state.edits.layers
    rows = [(one.title, _extent(one), one.opacity * one.on) for one in reversed(layers)]
    place = state.layer
    chosen = -1 if place is None or _layer(state) is None else len(layers) - 1 - place
    return {"rows": rows, "chosen": chosen}


def _extent(layer: Layer) -> str:
    """Return how much a layer covers, and how strongly."""
    mask, content = layer.mask, layer.content
    if not layer.on:
        return "off"
    vertices = content.vertices if isinstance(content, Painted) else mask.vertices
    where = "part" if mask.part is not None else "all"
    if vertices is not None:
        where = f"{len(vertices):,}"
    return where if layer.opacity == 1 else f"{where} · {layer.opacity:.0%}"


def _choose(session: Session, row: int) -> None:
    """Choose a layer; the chosen one again: none."""
    state = session.state
    place = len(state.edits.layers) - 1 - row
    state.layer = None if place == state.layer else place


def _about(state: State) -> str:
    """Describe the chosen layer."""
    layer = _layer(state)
    if layer is None:
        return ABOUT
    names, where = layer.content.joints_named(), ""
    if isinstance(layer.content, Painted):
        where = f" at {count(len(layer.content.vertices), 'vertex')}"
    elif names:
        where = f": {listed(list(names))}"
    covers = " It replaces all weights below it." if layer.is_reach and layer.on else ""
    return f"{layer.content.title}{where}.{covers}"


def _sets(name: str) -> Any:
    """Return an action that sets a field of the chosen layer."""

    def act(session: Session, value: Any) -> None:
        if session.state.layer is not None:
            commands.set_layer(session, session.state.layer, **{name: value})

    return act


def _reads(name: str, default: Any) -> Any:
    return lambda state: default if _layer(state) is None else getattr(_layer(state), name)


def _moves(by: int) -> Any:
    def can(state: State) -> bool:
        place = state.layer
        if place is None or _layer(state) is None:
            return True
        return not 0 <= place + by < len(state.edits.layers)

    def act(session: Session) -> None:
        commands.change(session, lambda edits, place: stack.moved(edits, place, by))

    return {"act": act, "disabled": can}


def _delete(session: Session) -> None:
    commands.change(session, lambda edits, place: (stack.replaced(edits, place, None), None))


def _adds(content: Any) -> Any:
    """Return an action that adds a layer over the selection, or over everything."""

    def act(session: Session) -> None:
        chosen = selected(session.state)
        vertices = None if chosen is None else np.flatnonzero(chosen)
        commands.put_content(session, vertices, lambda: content(session))

    return act


def _lock(session: Session) -> Content:
    return Locked([session.state.rig.skeleton.names[session.state.joint]])


NEW_LAYERS = {
    "From file": _adds(lambda session: commands.FromFile()),
    "Computed, paper": _adds(lambda session: Computed({"method": "paper"})),
    "Computed, finer": _adds(
        lambda session: Computed({"resolution": 2 * session.state.resolution})
    ),
    "Smoothed": _adds(lambda session: Smoothed(2)),
    "Smoothed through the body": _adds(lambda session: Smoothed(2, through=True)),
    "Left side on both": _adds(lambda session: Mirrored("left")),
    "Right side on both": _adds(lambda session: Mirrored("right")),
    "With the body it touches": _adds(lambda session: Attached()),
    "Selected bone locked": _adds(_lock),
}
MODES = {mode.capitalize(): mode for mode in get_args(Mode)}
LAYERS = ui.folded(
    "Layers",
    ui.column(
        ui.Control(
            Rows, act=_choose, shows=_rows, label="Layers",
            styles={"--bar": "var(--mui-palette-text-secondary, #667)"}, **ui.FULL,
        ),
        margin=ui.GAP, max_height=200, scroll="y",
        visible=lambda state: len(state.edits.layers) > 0,
    ),
    ui.caption(_about),
    ui.column(
        ui.text_box("Name of the layer", act=_sets("name"), value=_reads("name", "")),
        ui.switch("", label="On", act=_sets("on"), value=_reads("on", True)),
        ui.slider(
            "", label="Opacity", act=_sets("opacity"), value=_reads("opacity", 1.0),
            start=0, end=1, step=0.05, format="0%",
        ),
        ui.pick(
            "Mode", lambda state: list(MODES),
            lambda state: [*MODES.values()].index(_reads("mode", "replace")(state)),
            lambda session, place: _sets("mode")(session, [*MODES.values()][place]),
        ),
        ui.row(
            ui.button("Up", margin=ui.BESIDE, **_moves(1)),
            ui.button("Down", margin=ui.BESIDE, **_moves(-1)),
            ui.button("Delete", _delete),
        ),
        ui.menu("Mask", "texture", MASKS),
        ui.button("Merge down", commands.merge_down, disabled=lambda state: not state.layer),
        visible=lambda state: _layer(state) is not None,
    ),
    ui.menu("Add layer", "add", NEW_LAYERS, disabled=lambda state: state.binding is None),
    ui.caption(NEW),
    needed=lambda state: _layer(state) is not None,
    visible=lambda state: state.binding is not None,
)  # fmt: skip
