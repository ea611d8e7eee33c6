"""The selection: what is selected, what its weights are, and what is done with them."""

import panel_material_ui as pmui

from cutcell.runtime.display import count
from cutcell_viewers.short_names import short_names

from ...document.selection import selected, selected_vertices
from ...document.session import Session
from ...document.state import State
from ...looks.histogram import histogram_rows, in_bars
from ...widgets import controls as ui
from ...widgets.weights_table import Histogram, WeightsTable
from ..layers.buttons import blend_button, file_button, recompute_button
from .operations import OPERATIONS, move, source_joint
from .saved import SAVED
from .selections import SELECTIONS, select_bars, select_where
from .table import act, table_parts, table_text

HOW = "S chooses the strongest bone under the pointer, Q takes the lasso, ? lists all keys."
WHERE = 'weight of "hand.L" > 0.1 and distance > 0.3'
ALL = "All bones"
LATE = ("binding", "brush_selection")


def _about(state: State) -> str:
    chosen = selected(state)
    if chosen is None:
        return "No vertices are selected."
    limits = " Strokes are limited to them." if state.brush else ""
    return f"{count(int(chosen.sum()), 'vertex')} of {len(chosen):,} selected.{limits}"


def _is_selected(state: State) -> bool:
    return selected(state) is not None


def _move_label(state: State) -> str:
    name = ui.joint_title(state.rig, state.joint) if ui.has_joint(state) else "the bone"
    return f"Move weight to {name}"


def _sources(state: State) -> list[str]:
    return [ALL, *([] if state.rig is None else short_names(state.rig.skeleton.names))]


def _source(state: State) -> int:
    source = None if state.rig is None else source_joint(state)
    return 0 if source is None else source + 1


def _choose_source(session: Session, place: int) -> None:
    names = session.state.rig.skeleton.names
    session.state.move_from = names[place - 1] if place else ""


def _bars_text(state: State) -> str:
    if not ui.has_joint(state) or state.rows is None:
        return ""
    chosen, name = in_bars(state), ui.joint_title(state.rig, state.joint)
    if chosen is None:
        which = "selected vertices" if _is_selected(state) else "all vertices"
        return f"Weights of {name} at {which}, without zeros. Click or drag across bars."
    return f"{count(int(chosen.sum()), 'vertex')} in these bars."


def _choose_bars(session: Session, bars: tuple[int, int]) -> None:
    session.state.bars = None if bars == session.state.bars else bars


def _is_bone(state: State) -> bool:
    return bool(state.weights_shown == "bone")


WEIGHT_SCALE = ui.column(
    ui.choice("weight_scale"),
    ui.select("colormap", "Colour map", margin=(10, 0, 4, 0)),
    ui.slider("weight_limit", format="0.000", visible=lambda s: s.weight_scale == "limit"),
    ui.switch("weight_outline"),
    visible=_is_bone,
)
"""How colours show the weight of one joint."""

CHANGES = ui.column(
    ui.pick("Move weight of", _sources, _source, _choose_source, searchable=True),
    ui.button(_move_label, move, icon="call_merge"),
    ui.slider("amount"),
    ui.slider("passes", pmui.IntSlider),
    ui.menu("Change weights", "tune", OPERATIONS),
    recompute_button(selected_vertices),
    file_button(selected_vertices),
    blend_button(selected_vertices),
    visible=_is_selected,
)

SELECTION = ui.folded(
    "Selection",
    ui.caption(_about),
    ui.row(
        ui.menu("Select by", "highlight_alt", SELECTIONS, margin=ui.BESIDE),
        ui.column(ui.switch("lasso"), ui.switch("isolated")),
    ),
    ui.switch("lasso_through", visible=lambda s: s.lasso),
    ui.text_box(
        "Vertices where",
        act=select_where,
        value=lambda s: s.condition,
        placeholder=WHERE,
        repeats=True,
    ),
    SAVED,
    CHANGES,
    ui.switch("table"),
    ui.caption(table_text, visible=lambda s: s.table, late=LATE),
    ui.Control(
        WeightsTable, act=act, shows=table_parts, late=LATE, label="Weights of the selection",
        visible=lambda s: s.table, margin=ui.GAP, **ui.WIDE,
    ),
    ui.switch("histogram"),
    ui.column(
        ui.caption(_bars_text, late=LATE),
        ui.Control(
            Histogram, act=_choose_bars, shows=histogram_rows, late=LATE,
            label="Vertices by weight", margin=ui.GAP, **ui.WIDE,
        ),
        ui.button("Select these", select_bars, visible=lambda s: s.bars is not None),
        visible=lambda s: s.histogram,
    ),
    ui.caption(HOW),
    needed=lambda s: s.lasso or _is_selected(s),
    visible=lambda s: s.binding is not None,
)  # fmt: skip
