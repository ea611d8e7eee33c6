"""The card of the tour, over the canvas: text, formula, dots, back and next."""

from typing import Any

import param
from panel.custom import JSComponent
from panel.models.katex import KATEX_VERSION

from ..commands.session import Session
from ..commands.tour import go, offer, pressed_offers
from ..state.tour import TOUR
from .modules import script, style


class TourCard(JSComponent):
    """Shows one step; tells which one is asked for."""

    step = param.Integer(-1, doc="Which step is told; -1 shows nothing.")
    steps = param.List([], doc="Title, text, formula, what to look at, and buttons, of each.")
    taken = param.List([], doc="Whether what each of the step's buttons chooses is chosen.")
    katex_url = param.String(
        f"static/extensions/panel/bundled/katex/katex@{KATEX_VERSION}/dist/katex.min.js",
        constant=True,
        doc="Where Panel's own server keeps KaTeX.",
    )

    _esm = script("tour_card")

    def __init__(self, session: Session, **params: Any) -> None:
        super().__init__(**params)
        self._session = session

    def _handle_msg(self, data: dict[str, Any]) -> None:
        if data.get("type") == "step":
            go(self._session, int(data["step"]))
        elif data.get("type") == "offer":
            offer(self._session, int(data["index"]))


def tour_card(session: Session) -> TourCard:
    """Return the card of a session's tour."""
    state = session.state
    steps = [
        {
            "title": s.title, "text": s.text, "formula": s.formula, "task": s.task,
            "offers": [one.label for one in s.offers],
        }
        for s in TOUR
    ]  # fmt: skip
    card = TourCard(
        session,
        step=state.tour,
        taken=pressed_offers(state),
        steps=steps,
        stylesheets=[style("tour_card_place")],
        margin=0,
    )

    def update(*events: Any) -> None:
        card.param.update(step=state.tour, taken=pressed_offers(state))

    names = {name for step in TOUR for one in step.offers for name in one.choices}
    state.param.watch(update, ["tour", *sorted(names)])
    return card
