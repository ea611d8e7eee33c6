"""Status of the work: progress, counts and seconds, warnings, errors."""

from typing import Any

import numpy as np
import panel_material_ui as pmui

from cutcell.graph import INTERIOR, MESH, SURFACE
from cutcell.rig import Rig

from ..document.session import Session
from ..document.state import State
from ..editing.binding.recovery import cancel
from ..server.messages import sentence, visible_text
from ..widgets import controls as ui
from ..widgets.modules import style

TITLES = {
    "compile": "Compiling, once on this machine (about a minute)",
    "graph": "Building the graph",
    "distances": "Measuring distances",
    "weights": "Computing weights",
}
SHADOW = {"bgcolor": "background.paper", "boxShadow": "0 4px 18px rgba(10, 20, 40, .16)"}
BUTTONS = {
    **SHADOW,
    "borderRadius": "8px",
    "flexWrap": "wrap",
    "width": "fit-content",
    "marginLeft": "16px",
    "padding": "2px 4px",
}
"""The buttons below a warning."""

# The line keeps its height whatever it says: the canvas above must not jump.
_CUT = {"whiteSpace": "nowrap", "overflow": "hidden", "textOverflow": "ellipsis"}
_LINE = {
    "fontSize": "12px",
    "lineHeight": 1.4,
    "fontVariantNumeric": "tabular-nums",
    "display": "block",
    **_CUT,
    "& > p": {**_CUT, "margin": 0},  # the text is in a separate paragraph
}


def warning(state: State) -> tuple[str, str] | None:
    """Return the warnings about the result as one message."""
    texts = [link.text for link in state.warnings]
    return ("warning", " ".join(sentence(visible_text(text)) for text in texts)) if texts else None


def stage_text(stage: str) -> str:
    """Return the text of a stage."""
    return TITLES.get(stage, sentence(stage).rstrip(".") if stage else "Starting")


def progress_text(state: State) -> str:
    """Return the text of what is computed, and of an export that waits or is written meanwhile."""
    text = stage_text(state.stage)
    return f"{text} · Export: {state.exporting}" if state.exporting else text


def _counts(rig: Rig) -> str:
    mesh, joints = rig.mesh, len(rig.skeleton.joints)
    return f"{len(mesh.vertices):,} vertices · {len(mesh.faces):,} faces · {joints} joints"


def summary(state: State) -> str:
    """Return the counts and the seconds, in one line."""
    rig, binding = state.rig, state.binding
    if state.panel == "pairs" and state.beside is not None:
        return "  |  ".join(_counts(one) for one in state.beside.rigs)
    if rig is None:
        return ""
    parts = [_counts(rig)]
    if state.graph is not None:
        graph = state.graph
        kinds = np.bincount(graph.edge_kind, minlength=3)
        parts.append(
            f"{len(graph.nodes):,} nodes · {len(graph.edges):,} edges ({kinds[MESH]:,} mesh, "
            f"{kinds[INTERIOR]:,} interior, {kinds[SURFACE]:,} surface)"
        )
    if binding is not None:
        seconds = binding.seconds.items()
        parts.append(" · ".join(f"{stage} {value:.2f} s" for stage, value in seconds))
    return "  |  ".join(parts)


def _is_busy(state: State) -> bool:
    return bool(state.busy)


STATUS_LINE = ui.row(
    ui.text_line(
        progress_text,
        visible=_is_busy,
        sx={**_LINE, "minWidth": "150px", "maxWidth": "46vw"},
        margin=(10, 8, 10, 16),
    ),
    ui.Control(
        pmui.LinearProgress,
        value=lambda state: round(100 * state.fraction),
        visible=_is_busy,
        variant="determinate",
        margin=(17, 8),
        **ui.WIDE,
    ),
    ui.button("Cancel", cancel, variant="text", visible=_is_busy, margin=(4, 12), sizing_mode=None),
    ui.text_line(
        summary,
        visible=lambda state: not state.busy,
        sx={**_LINE, "color": "text.secondary"},
        margin=(10, 16),
        **ui.WIDE,
    ),
    sx={
        "height": "38px",
        "overflow": "hidden",
        "borderTop": "1px solid",
        "borderColor": "divider",
        "bgcolor": "background.paper",
    },
)
"""The slim line under the canvas."""


def messages(session: Session) -> pmui.Column:
    """Return the place over the canvas where errors and warnings are shown."""
    state = session.state
    # The sentence is the title: titles are shown as they are, never read as HTML.
    alert = pmui.Alert(
        closeable=True, margin=0, visible=False, variant="outlined", **ui.WIDE,
        sx={**SHADOW, "& .MuiAlertTitle-root": {"fontSize": 13, "fontWeight": 400, "m": 0}},
    )  # fmt: skip
    buttons = pmui.Row(margin=(6, 0, 0, 0), visible=False, sx=BUTTONS)

    def update(*events: Any) -> None:
        of_edits = [one.name == "binding_warnings" and one.old is not None for one in events]
        if events and all(of_edits) and alert.closed and state.binding_warnings is not None:
            return  # it stays closed until distances change
        # A step asks before it shows what the warnings say.
        expected = warning(state) if state.lesson_step is None else None
        severity, text = state.message or expected or ("info", "")
        alert.param.update(severity=severity, title=text, closed=False, visible=bool(text))
        linked = [] if state.message or not expected else state.warnings
        links = [link for link in linked if link.code]
        buttons.objects = [ui.draw(session, _button(link)) for link in links]
        buttons.visible = bool(links)

    def closed(event: Any) -> None:
        if event.new:
            alert.visible = buttons.visible = False

    state.param.watch(update, ["message", "binding_warnings", "built_graph", "step"])
    alert.param.watch(closed, "closed")
    place = ui.column(
        alert, buttons, stylesheets=[style("page/messages_place")],
        css_classes=lambda state: ["beside-lesson"] if state.step >= 0 else [],
    )  # fmt: skip
    return ui.draw(session, place)


def _button(link: Any) -> Any:
    """Return the button that leads from a warning to its elements, and to what can be done."""

    def act(session: Session) -> None:
        session.state.param.update(panel="check", finding=link.code)

    return ui.button(
        link.label, act, icon="my_location", variant="text",
        margin=(0, 4), sizing_mode=None,
    )  # fmt: skip
