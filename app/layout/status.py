"""Status of the work: progress, counts and seconds, warnings, errors."""

from typing import Any

import numpy as np
import panel_material_ui as pmui

from cutcell.graph import INTERIOR, MESH, SURFACE
from cutcell.rig import Rig

from ..commands.binding import cancel
from ..commands.check import go_to
from ..commands.session import Session
from ..jobs.messages import sentence, visible_text
from ..panels.controls import column, row, text_line, when
from ..scenes.warnings import Door, warnings
from ..state import State
from ..widgets.modules import style

TITLES = {
    "compile": "Compiling, once on this machine (about a minute)",
    "graph": "Building the graph",
    "distances": "Measuring distances",
    "weights": "Computing weights",
}


DOORS = {
    "bgcolor": "background.paper",
    "borderRadius": "8px",
    "boxShadow": "0 4px 18px rgba(10, 20, 40, .16)",
    "flexWrap": "wrap",
    "width": "fit-content",
    "marginLeft": "16px",
    "padding": "2px 4px",
}
"""The buttons below a warning."""

# The line keeps its height whatever it says: the canvas above must not jump.
_CUT = {"whiteSpace": "nowrap", "overflow": "hidden", "textOverflow": "ellipsis"}
# The text is in a separate paragraph.
_ONE_LINE = {"display": "block", **_CUT, "& > p": {**_CUT, "margin": 0}}


def status_line(session: Session) -> pmui.Row:
    """Return the slim line under the canvas."""
    state = session.state
    small = {"fontSize": "12px", "lineHeight": 1.4, "fontVariantNumeric": "tabular-nums"}
    counts = text_line(
        when(
            lambda *_: summary(state),
            state.param.rig,
            state.param.binding,
            state.param.bare_graph,
            state.param.panel,
            state.param.beside,
        ),
        visible=when(lambda busy: not busy, state.param.busy),
        sx={**small, **_ONE_LINE, "color": "text.secondary"},
        margin=(10, 16),
        sizing_mode="stretch_width",
    )
    stage = text_line(
        when(
            progress_text,
            state.param.stage,
            state.param.exporting,
        ),
        visible=state.param.busy,
        sx={**small, **_ONE_LINE, "minWidth": "150px", "maxWidth": "46vw"},
        margin=(10, 8, 10, 16),
    )
    bar = pmui.LinearProgress(
        value=when(lambda fraction: round(100 * fraction), state.param.fraction),
        visible=state.param.busy,
        variant="determinate",
        sizing_mode="stretch_width",
        margin=(17, 8),
    )
    stop = pmui.Button(
        label="Cancel",
        size="small",
        variant="text",
        visible=state.param.busy,
        on_click=lambda event: cancel(session),
        margin=(4, 12),
    )
    return row(
        stage,
        bar,
        stop,
        counts,
        sx={
            "height": "38px",
            "overflow": "hidden",
            "borderTop": "1px solid",
            "borderColor": "divider",
            "bgcolor": "background.paper",
        },
    )


def messages(session: Session) -> pmui.Column:
    """Return the place over the canvas where errors and warnings are shown."""
    state = session.state
    # The sentence is the title: titles are shown as they are, never read as HTML.
    appearance = {
        "bgcolor": "background.paper",
        "boxShadow": "0 4px 18px rgba(10, 20, 40, .16)",
        "& .MuiAlertTitle-root": {"fontSize": 13, "fontWeight": 400, "m": 0},
    }
    alert = pmui.Alert(
        closeable=True, margin=0, sizing_mode="stretch_width", visible=False, sx=appearance,
        variant="outlined",
    )  # fmt: skip

    def update(*events: Any) -> None:
        if events and all(only_weights(event) for event in events):
            return  # the warnings did not change
        severity, text = state.message or warning(state) or ("info", "")
        alert.param.update(severity=severity, title=text, closed=False, visible=bool(text))
        leads = [] if state.message else [door for door in warnings(state) if door.code]
        doors.objects = [_door(session, door) for door in leads]
        doors.visible = bool(leads)

    def closed(event: Any) -> None:
        if event.new:
            alert.visible = doors.visible = False

    state.param.watch(update, ["message", "binding", "bare_graph"])
    alert.param.watch(closed, "closed")
    doors = pmui.Row(margin=(6, 0, 0, 0), visible=False, sx=DOORS)
    place = column(alert, doors, stylesheets=[style("messages_place")])

    def update_pair(*events: Any) -> None:
        place.css_classes = ["beside-tour"] if state.tour >= 0 else []

    state.param.watch(update_pair, "tour")
    update_pair()
    return place


def _door(session: Session, door: Door) -> pmui.Button:
    """Return what leads from a warning to its elements, and to what can be done about it."""
    return pmui.Button(
        label=door.label,
        icon="my_location",
        size="small",
        variant="text",
        margin=(0, 4),
        on_click=lambda event: go_to(session, door.code),
    )


def only_weights(event: Any) -> bool:
    """Whether a change of the binding left the distances as they were."""
    old, new = event.old, event.new
    is_update = event.name == "binding" and old is not None and new is not None
    return is_update and old.distances is new.distances


def warning(state: State) -> tuple[str, str] | None:
    """Return what a person should know about the result."""
    texts = [door.text for door in warnings(state)]
    return ("warning", " ".join(sentence(visible_text(text)) for text in texts)) if texts else None


def stage_text(stage: str) -> str:
    """Return the text of a stage."""
    return TITLES.get(stage, sentence(stage).rstrip(".") if stage else "Starting")


def progress_text(stage: str, exporting: str) -> str:
    """Return the text of what is computed, and of an export that waits or is written meanwhile."""
    text = stage_text(stage)
    return f"{text} · Export: {exporting}" if exporting else text


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
