"""Geodesics: how far the chosen bone is, through the body."""

from __future__ import annotations

import panel_material_ui as pmui

from ..session import Session
from .parts import caption, cutting, section, when


def geodesics(session: Session) -> pmui.Column:
    """Return the controls of the panel Geodesics."""
    state = session.state
    idle = caption(
        "This bone carries no weight, so no distance begins at it.",
        visible=when(
            lambda rig, joint: rig is not None and not rig.skeleton.deform[joint],
            state.param.rig,
            state.param.joint,
        ),
    )
    return section("Distance from the bone", idle, *cutting(state))
