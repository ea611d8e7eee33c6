"""Weights: how much each bone holds."""

from __future__ import annotations

import panel_material_ui as pmui

from ..session import Session
from .parts import choice, section

SHOWN = {"All bones": "mix", "Chosen bone": "bone"}


def weights(session: Session) -> pmui.Column:
    """Return the controls of the panel Weights."""
    return section("Weights", choice(session.state.param.weights_shown, SHOWN))
