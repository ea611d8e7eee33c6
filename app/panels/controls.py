"""Controls shared by the sections of the sidebar."""

import re
from collections import Counter
from collections.abc import Callable, Sequence
from typing import Any

import panel as pn
import panel_material_ui as pmui
import param

from cutcell.rig import Rig
from cutcell.runtime.display import printable, shown_name
from cutcell_viewers.short_names import short_names

from ..commands import pose
from ..commands.session import Session

GAP = (4, 0)
"""Space above and below a widget, and beside it."""
BESIDE = (4, 8, 4, 0)
"""The same, with space for what comes beside it."""
LINE: dict[str, Any] = {
    "variant": "text",
    "margin": 0,
    "sx": {"justifyContent": "flex-start", "textAlign": "left", "color": "text.primary"},
}
"""How a button looks that is a line of a list."""
FULL: dict[str, Any] = {"margin": 0, "sizing_mode": "stretch_width"}
CONTROL: dict[str, Any] = {"size": "small", "margin": GAP, "sizing_mode": "stretch_width"}


def as_text(text: str) -> str:
    """Return a text that Panel shows as it stands: it takes texts for Markdown, and so for HTML.

    Names of joints in a file could otherwise contain a script.
    """
    return _PUNCTUATION.sub(lambda match: f"&#{ord(match.group())};", printable(text or ""))


_PUNCTUATION = re.compile(r"[!-&(-+\-/<-@\[-`{-~]|[.:](?=\S)|(?<=\d)\.")
"""All but what ends sentences and their parts; an address, for one, would become a link."""


def text_line(text: Any, **params: Any) -> pmui.Typography:
    """Return a text, or what follows a parameter, as it stands."""
    content = as_text(text) if isinstance(text, str) else when(as_text, text)
    return pmui.Typography(content, **params)


def section(title: str, *objects: Any, **params: Any) -> pmui.Column:
    """Return a section of the sidebar, with a heading if it has a title."""
    params = {"margin": (14, 20, 4, 20), "sizing_mode": "stretch_width", **params}
    if not title:
        return pmui.Column(*objects, **params)
    heading = text_line(
        title,
        variant="overline",
        margin=(0, 0, 2, 0),
        sx={"fontWeight": 600, "letterSpacing": "0.08em", "color": "text.secondary"},
    )
    return pmui.Column(heading, *objects, **params)


def folded(title: str, *objects: Any, needed: Any = None, **params: Any) -> pmui.Column:
    """Return a section that opens when its heading is pressed, or a parameter needs it."""
    content = column(*objects)
    accordion = pmui.Accordion(
        (title, content), margin=0, sizing_mode="stretch_width", elevation=0, sx=_FOLDED,
        disable_gutters=True, title_variant="overline",
    )  # fmt: skip

    def opened(*events: Any) -> None:
        value = getattr(needed.owner, needed.name)
        if value is not None and value is not False:  # a part may be 0
            accordion.active = [0]

    if needed is not None:
        needed.owner.param.watch(opened, needed.name)
        opened()
    return pmui.Column(accordion, margin=(2, 20), sizing_mode="stretch_width", **params)


_FOLDED = {
    "background": "none",
    "&::before": {"display": "none"},
    "& .MuiAccordionSummary-root": {"minHeight": 36, "p": 0},
    "& .MuiAccordionSummary-content": {"my": "4px !important"},
    "& .title": {"fontWeight": 600, "letterSpacing": "0.08em", "color": "text.secondary"},
    "& .MuiAccordionDetails-root": {"p": "0 !important"},
}


def intro(text: Any) -> pmui.Typography:
    """Return the sentence that a panel begins with: what is seen there."""
    style = {"fontSize": "13px", "lineHeight": 1.45, "color": "text.primary", "display": "block"}
    return text_line(text, sx=style, margin=(12, 20, 0, 20), sizing_mode="stretch_width")


def caption(text: Any = "", **params: Any) -> pmui.Typography:
    """Return a line of small, quiet text."""
    style = {"color": "text.secondary", "lineHeight": 1.45, "display": "block", "letterSpacing": 0}
    params = {"margin": (2, 0, 6, 0), "sizing_mode": "stretch_width", **params}
    return text_line(text, variant="caption", sx=style, **params)


def when(function: Callable[..., Any], *parameters: Any) -> Any:
    """Return a value that follows parameters: `function` of theirs, ever again."""
    return pn.bind(function, *parameters)


def unique_names(names: Sequence[str]) -> list[str]:
    """Return names to be shown, of which none comes twice: the second gets "(2)" added."""
    unique: dict[str, None] = {}
    numbers: Counter[str] = Counter()
    for name in map(shown_name, names):
        numbered = name
        while numbered in unique:
            numbers[name] += 1
            numbered = f"{name} ({numbers[name] + 1})"
        unique[numbered] = None
    return list(unique)


def joint_title(rig: Rig, joint: int) -> str:
    """Return a joint's name as the page shows it."""
    return short_names(rig.skeleton.names)[joint]


def offer(select: pmui.Select, names: Sequence[str], index: int) -> None:
    """Offer names, which `unique_names` made, in a menu, and select one of them.

    Names, not indices, are its values: an index that stays would keep the name that it had. And
    at once: a menu whose value changes twice in a moment may tell the first one back.
    """
    select.param.update(options=list(names), value=names[index] if names else None)


BUTTONS: dict[str, Any] = {
    "label": "",
    "size": "small",
    "margin": GAP,
    "sizing_mode": "stretch_width",
    "sx": {"width": "100%", "& .MuiToggleButton-root": {"flex": 1, "py": "5px"}},
}
"""How a row of buttons looks, one of which is pressed."""


def follow(
    menu: Any,
    state: param.Parameterized,
    name: str,
    offered: Callable[[], tuple[dict[str, Any], Any]],
    watched: Sequence[str],
) -> Any:
    """Connect a menu to a parameter of the state.

    `offered` returns the menu's choices and the chosen one; it is called again whenever the
    parameter or one of those watched changes.
    """

    def listed(*events: Any) -> None:
        options, value = offered()
        menu.param.update(options=options, value=value)

    def chosen(event: Any) -> None:
        if event.new not in (None, offered()[1]):  # else nobody chose it
            setattr(state, name, event.new)

    state.param.watch(listed, [*watched, name])
    menu.param.watch(chosen, "value")
    listed()
    return menu


def choice(parameter: Any, options: dict[str, Any], **params: Any) -> pmui.RadioButtonGroup:
    """Return a row of buttons, one of which is pressed."""
    return pmui.RadioButtonGroup.from_param(parameter, options=options, **BUTTONS, **params)


def slider(parameter: Any, label: str, whole: bool = False, **params: Any) -> Any:
    """Return a slider that follows a parameter while it is dragged."""
    kind = pmui.IntSlider if whole else pmui.FloatSlider
    style = {"size": "small", "margin": GAP, "sizing_mode": "stretch_width", "description": ""}
    if not whole:
        style["format"] = "0.00"
    made: Any = kind.from_param(parameter, **{"label": label, **style, **params})
    # Panel holds a change back for 50 ms in case another follows; what is seen must not wait.
    made._priority_changes = ["value"]
    return made


def has_weights(rig: Any) -> bool:
    """Whether a character has weights in its file."""
    return rig is not None and rig.weights is not None


def switch(parameter: Any, **params: Any) -> pmui.Switch:
    """Return a switch that follows a parameter, under the parameter's own label."""
    params = {"label": parameter.label, "size": "small", "margin": (3, 0), **params}
    return pmui.Switch.from_param(parameter, description="", **params)


def button(label: Any, act: Callable[[], Any], **params: Any) -> pmui.Button:
    """Return a button that fills the width."""
    params = {**CONTROL, "variant": "outlined", **params}
    return pmui.Button(label=label, on_click=lambda event: act(), **params)


def play_button(running: Any, act: Callable[[], Any], noun: str = "", **params: Any) -> pmui.Button:
    """Return a button that starts and pauses what a parameter says is running."""
    label = when(lambda on: ("Pause" if on else "Play") + noun, running)
    icon = when(lambda on: "pause" if on else "play_arrow", running)
    return button(label, act, icon=icon, **params)


def rest_button(session: Session) -> pmui.Button:
    """Return the button that lets the character rest."""
    state = session.state
    at_rest = when(lambda *_: not state.posed, state.param.turns, state.param.moving)
    return button("Rest pose", lambda: pose.rest(session), disabled=at_rest)


def select_box(label: str, options: Any = (), **params: Any) -> Any:
    """Return a menu of options."""
    options = options if isinstance(options, dict) else list(options)
    return pmui.Select(label=label, options=options, **{**CONTROL, **params})


def text_box(label: str, **params: Any) -> Any:
    """Return a field of text."""
    return pmui.TextInput(label=label, value="", **{**CONTROL, "margin": (8, 0), **params})


def column(*objects: Any, **params: Any) -> pmui.Column:
    """Return objects below each other, without space around them."""
    return pmui.Column(*objects, **{**FULL, **params})


def row(*objects: Any, **params: Any) -> pmui.Row:
    """Return objects beside each other, without space around them."""
    return pmui.Row(*objects, **{**FULL, **params})


def menu(label: str, icon: str, acts: dict[str, Callable[[], Any]], **params: Any) -> Any:
    """Return a button that opens a menu, each item of which acts."""
    items = [{"label": name} for name in acts]
    params = {**CONTROL, "variant": "outlined", **params}
    opened: Any = pmui.MenuButton(label=label, icon=icon, items=items, **params)
    opened.on_click(lambda item: acts[item["label"]]())
    return opened


def weightless(rig: Any, joint: int) -> bool:
    """Whether a joint is there that carries no weight."""
    return rig is not None and joint < len(rig.skeleton.deform) and not rig.skeleton.deform[joint]
