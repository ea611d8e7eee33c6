"""Rows of the tables that the sidebar is drawn from, each kind with its style."""

from collections.abc import Callable, Mapping, Sequence
from typing import Any

import panel_material_ui as pmui

from cutcell.method import OPTIONS
from cutcell.options import Flag, Whole

from ..document.session import Session
from ..document.state import State
from .table import Control, draw
from .text import as_text, joint_title, unique_names

__all__ = ["Control", "as_text", "draw", "joint_title", "unique_names"]

GAP = (4, 0)
"""Space above and below a widget, and beside it."""
BESIDE = (4, 8, 4, 0)
"""The same, with space for the widget beside it."""
WIDE: dict[str, Any] = {"sizing_mode": "stretch_width"}
FULL: dict[str, Any] = {"margin": 0, **WIDE}
SMALL: dict[str, Any] = {"size": "small", "margin": GAP, **WIDE}
QUIET = {"color": "text.secondary", "lineHeight": 1.45, "display": "block", "letterSpacing": 0}
"""Style of small text."""
LINE: dict[str, Any] = {
    "variant": "text",
    "margin": 0,
    "sx": {"justifyContent": "flex-start", "textAlign": "left", "color": "text.primary"},
}
"""Style of a button that is a line of a list."""
HEADING = {"fontWeight": 600, "letterSpacing": "0.08em", "color": "text.secondary"}
FOLDED = {
    "background": "none",
    "&::before": {"display": "none"},
    "& .MuiAccordionSummary-root": {"minHeight": 36, "p": 0},
    "& .MuiAccordionSummary-content": {"my": "4px !important"},
    "& .title": HEADING,
    "& .MuiAccordionDetails-root": {"p": "0 !important"},
}
BUTTONS = {"width": "100%", "& .MuiToggleButton-root": {"flex": 1, "py": "5px", "px": "3px"}}


def switch(name: str, **options: Any) -> Control:
    """Return a switch, under the parameter's own label."""
    return Control(pmui.Switch, name, **{"size": "small", "margin": (3, 0), **options})


def slider(name: str, kind: Any = pmui.FloatSlider, **options: Any) -> Control:
    """Return a slider that follows a parameter while it is dragged, in the parameter's steps."""

    def prompt(**options: Any) -> Any:
        widget = kind(**options)
        # Panel holds a change back for 50 ms in case another follows; the view must not wait.
        widget._priority_changes = ["value"]
        return widget

    style = {**SMALL, **({"format": "0.00"} if kind is pmui.FloatSlider else {})}
    return Control(prompt, name, declared=_range, **{**style, **options})


def _range(parameter: Any) -> dict[str, Any]:
    """Return the bounds of a number, and its steps."""
    start, end = parameter.get_soft_bounds()
    return {"start": start, "end": end, "step": parameter.step or 1}


def choice(name: str, title: str = "", above: int = 2, **options: Any) -> Any:
    """Return a row of buttons, one of which is pressed, below a title if it has one."""
    style = {**SMALL, "label": "", "sx": BUTTONS}
    buttons = Control(pmui.RadioButtonGroup, name, declared=_choices, **{**style, **options})
    shared = {"visible": options["visible"]} if "visible" in options else {}
    return [caption(title, margin=(above, 0, 0, 0), **shared), buttons] if title else buttons


def option(name: str, **options: Any) -> Any:
    """Return the control of an option of the method, as it is declared."""
    values, label = OPTIONS[name].values, OPTIONS[name].label
    if isinstance(values, Mapping):
        return choice(name, label, above=4, **options)
    if isinstance(values, Flag):
        return switch(name, margin=(4, 0, 2, 0), **options)
    return slider(name, *([pmui.IntSlider] if isinstance(values, Whole) else []), **options)


def select(name: str, label: Any, **options: Any) -> Control:
    """Return a menu."""
    style = {**SMALL, "label": label}
    return Control(pmui.Select, name, declared=_choices, **{**style, **options})


def _choices(parameter: Any) -> dict[str, Any]:
    """Return the values of a parameter by the labels that it was declared with."""
    return {"options": dict(getattr(parameter, "names", ()))}


def pick(
    label: Any,
    names: Callable[[Any], Sequence[str]],
    index: Callable[[Any], int],
    act: Callable[[Session, int], Any],
    **options: Any,
) -> Control:
    """Return a menu of names, of which some may be equal.

    Names, not indices, are its values: an index that stays would keep the name that it had.
    `names` and `index` are functions of the state; `act` is called with the session and the index
    of the one that a person chooses.
    """

    def shows(state: State) -> dict[str, Any]:
        titles = unique_names(names(state))
        return {"options": titles, "value": titles[index(state)] if titles else None}

    def chosen(session: Session, title: str) -> None:
        act(session, unique_names(names(session.state)).index(title))

    return select("", label, act=chosen, shows=shows, **options)


def text_box(label: str, **options: Any) -> Control:
    """Return a field of text."""
    return Control(pmui.TextInput, **{**SMALL, "label": label, "margin": (8, 0), **options})


def button(label: Any, act: Callable[[Session], Any], **options: Any) -> Control:
    """Return a button that fills the width."""
    options = {**SMALL, "label": label, "variant": "outlined", **options}
    return Control(pmui.Button, act=lambda session, event: act(session), **options)


def play_button(
    act: Callable[[Session], Any], noun: str = "", running: str = "playing", **options: Any
) -> Control:
    """Return a button that starts and pauses what a parameter says is running."""
    return button(
        lambda state: ("Pause" if getattr(state, running) else "Play") + noun,
        act,
        icon=lambda state: "pause" if getattr(state, running) else "play_arrow",
        **options,
    )


def menu(label: str, icon: str, acts: dict[str, Callable[[Session], Any]], **options: Any) -> Any:
    """Return a button that opens a menu, each item of which acts."""

    def act(session: Session, item: dict[str, str]) -> None:
        acts[item["label"]](session)

    items = [{"label": name} for name in acts]
    style = {**SMALL, "label": label, "icon": icon, "variant": "outlined", "items": items}
    return Control(pmui.MenuButton, act=act, **{**style, **options})


def text_line(text: Any, **options: Any) -> Control:
    """Return a text, or one that follows the state, as it stands."""
    content = (lambda state: as_text(text(state))) if callable(text) else as_text(text)
    return Control(pmui.Typography, object=content, **options)


def caption(text: Any, **options: Any) -> Control:
    """Return a line of small, quiet text."""
    style = {"variant": "caption", "margin": (2, 0, 6, 0), "sx": QUIET, **WIDE}
    return text_line(text, **{**style, **options})


def intro(text: Any, **options: Any) -> Control:
    """Return the sentence that a panel begins with."""
    style = {"fontSize": "13px", "lineHeight": 1.45, "color": "text.primary", "display": "block"}
    return text_line(text, sx=style, margin=(12, 20, 0, 20), **WIDE, **options)


def column(*rows: Any, **options: Any) -> Control:
    """Return rows below each other, without space around them."""
    return Control(pmui.Column, content=rows, **{**FULL, **options})


def row(*rows: Any, **options: Any) -> Control:
    """Return rows beside each other, without space around them."""
    return Control(pmui.Row, content=rows, **{**FULL, **options})


def listed(rows: Callable[[Any], Sequence[Any]], **options: Any) -> Control:
    """Return rows below each other that a function of the state returns."""
    return Control(pmui.Column, content=rows, **{**FULL, **options})


def section(title: str, *rows: Any, top: int = 14, **options: Any) -> Control:
    """Return a section of the sidebar, with a heading if it has a title."""
    heading = text_line(title, variant="overline", margin=(0, 0, 2, 0), sx=HEADING)
    rows = ([heading] if title else [], *rows)
    return column(*rows, **{"margin": (top, 20, 4, 20), **options})


def folded(
    title: str, *rows: Any, needed: Callable[[Any], bool] = lambda state: False, **options: Any
) -> Control:
    """Return a section that opens when its heading is pressed, or the state needs it."""
    accordion = Control(
        lambda content, **options: pmui.Accordion((title, content), **options),
        content=[column(*rows)],
        shows=lambda state: {"active": [0]} if needed(state) else {},
        elevation=0, sx=FOLDED, disable_gutters=True, title_variant="overline", **FULL,
    )  # fmt: skip
    return column(accordion, **{"margin": (2, 20), **options})


def has_weights(state: State) -> bool:
    """Return whether the open character has weights in its file."""
    return state.rig is not None and state.rig.weights is not None


def has_joint(state: State) -> bool:
    """Return whether the chosen joint is one of the open character's."""
    return state.rig is not None and state.joint < len(state.rig.skeleton.names)


def weightless(state: State) -> bool:
    """Return whether the chosen joint carries no weight."""
    return has_joint(state) and not state.rig.skeleton.deform[state.joint]
