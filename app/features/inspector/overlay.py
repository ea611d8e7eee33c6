"""The card over the canvas that tells all about the clicked vertex."""

from functools import partial
from typing import Any

import param
from panel.custom import JSComponent

from ...document.address import from_query
from ...document.look import pick, pick_node, pick_vertex
from ...document.session import Session
from ...editing.correct.commands import overrule
from ...widgets.modules import script, style
from ...widgets.table import Control, draw
from .facts import node_facts, vertex_facts


class Inspector(JSComponent):
    """A card with the facts of one vertex; hidden without any."""

    facts = param.Dict(None, allow_None=True, doc="What `vertex_facts` or `node_facts` returns.")

    _esm = script("inspector")

    def __init__(self, session: Session, **params: Any) -> None:
        super().__init__(**params)
        self._session = session

    def _handle_msg(self, data: dict[str, Any]) -> None:
        if data.get("type") == "close":
            pick_vertex(self._session, None)
        elif data.get("type") == "explain":
            self._session.state.explain = not self._session.state.explain
        elif data.get("type") == "part":
            self._session.state.param.update(part=self._session.state.vertex, panel="weights")
        elif data.get("type") == "overrule":
            self._overrule(data["weights"])
        elif data.get("type") == "node":
            pick_node(self._session, int(data["node"]))
        elif data.get("type") == "bone":
            pick(self._session, int(data["joint"]))

    def _overrule(self, overrides: list[list[float]] | None) -> None:
        """Give the vertex weights, pairs of joint and weight; none for those that are computed."""
        session, vertex = self._session, self._session.state.vertex
        if vertex is None or session.state.binding is None:
            return
        weights = None if overrides is None else {int(joint): float(w) for joint, w in overrides}
        overrule(session, vertex, weights)


def overlay(session: Session) -> Inspector:
    """Return the card of a session, in its place over the canvas."""
    row = Control(
        partial(Inspector, session),
        facts=_facts,
        stylesheets=[style("inspector_place")],
        # Not by other stylesheets: Panel then asks for its own at a server far away.
        css_classes=lambda state: ["beside-lesson"] if state.step >= 0 else [],
        margin=0,
    )
    card: Inspector = draw(session, row)
    return card


def _facts(state: Any) -> dict[str, Any] | None:
    # Vertices that the lesson clicks are marked in the scene and need no card.
    node = node_facts(state, state.memo)
    return node or (None if points_out(state) else vertex_facts(state, state.memo))


def points_out(state: Any) -> bool:
    """Return whether the lesson chose the vertex, or waits for an answer.

    The card of a vertex would give the answer away.
    """
    step = state.lesson_step
    if step is None or state.vertex is None:
        return False
    if state.step not in state.answers:
        return True
    _, arrival, _ = from_query(step.scene(True), state)
    return bool(arrival.get("vertex") == state.vertex)
