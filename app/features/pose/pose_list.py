"""The list of saved poses and clips, with the largest stretch before and after the edits."""

from ...document.state import State
from ...widgets import controls as ui
from ...widgets.rows import Rows
from .poses import (
    FILES,
    NOW,
    delete,
    keys,
    missing,
    motions,
    rename,
    save,
    show,
    show_worst,
    shown_key,
    worst_of,
    worst_shown,
)
from .scene import has_rival


def chosen_row(state: State) -> int:
    """Return the row of what the character shows; -1 if none."""
    order, key = keys(state), shown_key(state)
    return order.index(key) if key in order else -1


def rows(state: State) -> list[tuple[str, str, float]]:
    """Return the rows of the list: a name, the largest stretch before and now, and a bar."""
    order, names = keys(state), motions(state)
    top = max((one.factor for key in order if (one := worst_of(state, NOW, key))), default=1.0)
    result = []
    for key in order:
        before, now = worst_of(state, FILES, key), worst_of(state, NOW, key)
        factors = [f"{one.factor:.2f}" for one in (before, now) if one is not None]
        title = key if isinstance(key, str) else names[key]
        result.append((title, " → ".join(factors), 0.0 if now is None else now.factor / top))
    return result


def _what(state: State) -> str:
    which = "by the file's weights → by the current ones" if has_rival(state) else "now"
    return f"How many times as long the worst edge becomes, {which}. Click a row to see it."


def _has_chosen(state: State) -> bool:
    return state.pose_name in state.edits.poses


SAVED = ui.section(
    "Poses",
    ui.text_box(
        "Save pose as", act=save, value=lambda state: state.pose_name, repeats=True,
        visible=lambda state: state.posed and not (state.moving and state.clip < 0),
    ),
    ui.caption(_what, visible=lambda state: bool(keys(state))),
    ui.Control(
        Rows,
        act=lambda session, row: show(session, keys(session.state)[row]),
        shows=lambda state: {"rows": rows(state), "chosen": chosen_row(state)},
        label="Poses and clips",
        margin=(0, -8),
        **ui.WIDE,
    ),
    ui.caption(missing, visible=lambda state: bool(missing(state))),
    ui.button(
        "Worst vertex", show_worst, icon="my_location",
        visible=lambda state: bool(keys(state)), disabled=lambda s: worst_shown(s) is None,
    ),
    ui.text_box(
        "Rename pose", act=rename, value=lambda state: state.pose_name, visible=_has_chosen
    ),
    ui.button("Delete pose", delete, icon="delete", visible=_has_chosen),
)  # fmt: skip
