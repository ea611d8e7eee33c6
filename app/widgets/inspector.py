"""The card over the canvas that tells all about the clicked vertex."""

from typing import Any

import param
from panel.custom import JSComponent

from ..commands.correct import overrule
from ..commands.look import pick, pick_node, pick_vertex
from ..commands.session import Session
from ..commands.tour import points_out
from ..scenes.facts import node_facts, vertex_facts
from .modules import script, style


class Inspector(JSComponent):
    """A card with the facts of one vertex; hidden without any."""

    facts = param.Dict(None, allow_None=True, doc="What `vertex_facts` or `node_facts` returns.")

    _esm = script("inspector")

    def __init__(self, session: Session, **params: Any) -> None:
        super().__init__(**params)
        self._session = session
        self._follow()
        names = ["rig", "binding", "bare_graph", "panel", "vertex", "node", "tour"]
        names += [
            "clicked_method",
            "methods",
            "compared",
            "comparing",
            "explain",
            "explanation",
            "corrections",
            "joint",
        ]
        session.state.param.watch(self._follow, names)

    def _follow(self, *events: Any) -> None:
        state = self._session.state
        # Vertices that the tour clicks are marked in the scene and need no card.
        memo = self._session.memo
        node = node_facts(state, memo)
        self.facts = node or (None if points_out(state) else vertex_facts(state, memo))

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


def inspector(session: Session) -> Inspector:
    """Return the card of a session, in its place over the canvas."""
    card = Inspector(session, stylesheets=[style("inspector_place")], margin=0)

    def place(*events: Any) -> None:
        # Not by other stylesheets: Panel then asks for its own at a server far away.
        card.css_classes = ["beside-tour"] if session.state.tour >= 0 else []

    session.state.param.watch(place, "tour")
    place()
    return card
