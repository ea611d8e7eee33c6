"""The card over the canvas that tells all about the clicked vertex."""

from functools import partial
from typing import Any

import param

from ...document.address import from_query
from ...document.look import pick, pick_node, pick_vertex
from ...document.session import Session
from ...document.state import State
from ...editing.correct.commands import overrule
from ...server.protocol.received import Close, Explain, Message, Override, Pick, PickNode, ShowPart
from ...widgets.modules import Widget, script, style
from ...widgets.table import Control, draw
from .facts import node_facts, vertex_facts


class Inspector(Widget):
    """A card with the facts of one vertex; hidden without any."""

    facts = param.Dict(None, allow_None=True, doc="What `vertex_facts` or `node_facts` returns.")

    _esm = script("widgets/inspector")

    def __init__(self, session: Session, **params: Any) -> None:
        super().__init__(**params)
        self._session = session

    def receive(self, message: Message) -> None:
        """Run the action of a button of the card."""
        session, state = self._session, self._session.state
        match message:
            case Close():
                pick_vertex(session, None)
            case Explain():
                state.explain = not state.explain
            case ShowPart():
                state.param.update(part=state.vertex, panel="weights")
            case Override(weights) if state.vertex is not None and state.binding is not None:
                overrule(session, state.vertex, None if weights is None else dict(weights))
            case PickNode(node):
                pick_node(session, node)
            case Pick(joint):
                pick(session, joint)


def overlay(session: Session) -> Inspector:
    """Return the card of a session, in its place over the canvas."""
    row = Control(
        partial(Inspector, session),
        facts=_facts,
        stylesheets=[style("widgets/inspector_place")],
        # Not by other stylesheets: Panel then asks for its own at a server far away.
        css_classes=lambda state: ["beside-lesson"] if state.step >= 0 else [],
        margin=0,
    )
    card: Inspector = draw(session, row)
    return card


def _facts(state: State) -> dict[str, Any] | None:
    # Vertices that the lesson clicks are marked in the scene and need no card.
    node = node_facts(state)
    return node or (None if points_out(state) else vertex_facts(state))


def points_out(state: State) -> bool:
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
