"""Take the result along: the character with its new weights, and a picture."""

from __future__ import annotations

from typing import Any

import panel_material_ui as pmui

from ..actions import take_along as actions
from ..session import Session
from .parts import GAP, caption, section, when


def take_along(session: Session) -> pmui.Column:
    """Return the section of the downloads."""
    state = session.state

    def bound(event: Any) -> None:
        actions.bound_file(session, session.view.offer)

    def picture(event: Any) -> None:
        actions.take_picture(session, session.view.offer)

    def button(label: str, act: Any, needed: Any, **params: Any) -> pmui.Button:
        return pmui.Button(
            label=label,
            size="small",
            margin=GAP,
            sizing_mode="stretch_width",
            on_click=act,
            disabled=when(lambda value: value is None, needed),
            **params,
        )

    return section(
        "Take along",
        button("Download the bound GLB", bound, state.param.binding, icon="download"),
        button("Picture (PNG)", picture, state.param.rig, icon="image", variant="outlined"),
        caption("All but the skin weights is as it was in the file."),
    )
