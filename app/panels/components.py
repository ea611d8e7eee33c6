"""Parts of the mesh: each glued to a joint, following the body, or bound by itself."""

from typing import Any

import panel_material_ui as pmui

from cutcell.editing.corrections import PartCorrection
from cutcell.runtime.display import shown_name
from cutcell_viewers.short_names import short_names

from ..commands import correct
from ..commands.session import Session
from ..scenes.components import MOST, Component, chosen, listed, vertices_of
from ..widgets.rows import Rows
from .controls import GAP, caption, column, folded, offer, select_box, unique_names

WAYS = {
    "As computed": "",
    "Rigid, to one joint": "glued",
    "With the body it touches": "touching",
    "Separately": "itself",
}
FROM_FILE = {"As in the file": "file"}
WATCHED = ["panel", "rig", "corrections", "part"]
SHORT = {"glued": "rigid", "touching": "follows", "itself": "separate", "file": "original"}


def parts_of_mesh(session: Session) -> pmui.Column:
    """Return the section that lists the connected components; hidden where there is one."""
    state, memo = session.state, session.memo
    about = caption()
    parts: list[Component] = []
    rows = Rows(
        lambda row: _choose(session, parts[row]),
        label="Parts of the mesh",
        sizing_mode="stretch_width",
        margin=0,
        styles={"--bar": "var(--mui-palette-text-secondary, #667)"},
    )
    place = column(rows, margin=GAP, max_height=200, scroll="y")
    way = select_box("Bind this part", WAYS, value="", margin=(16, 0, 4, 0))
    glue = select_box("Joint", margin=(12, 0, 4, 0), searchable=True)
    whole = folded("Parts of the mesh", about, place, way, glue, needed=state.param.part)

    def show() -> None:
        if state.panel != "weights":
            return  # it is shown when somebody looks
        parts[:] = listed(state, memo)
        whole.visible = len(parts) > 1
        if not whole.visible:
            return
        number = chosen(state, memo)
        most = max(one.vertices for one in parts)
        names = state.rig.skeleton.names
        rows.param.update(
            rows=[(_title(one), _follows(one, names), one.vertices / most) for one in parts],
            chosen=number,
        )
        more = " The largest are listed." if len(parts) == MOST else ""
        about.object = (
            f"{len(parts)} separate parts. Click to isolate one, again to show all.{more}"
        )
        way.visible = 0 <= number < len(parts)
        now = parts[number].correction if way.visible else None
        has_weights = state.rig.weights is not None
        how = "" if now is None else now.how
        # The largest part is the body itself.
        offered = {t: w for t, w in WAYS.items() if w != "touching" or number or w == how}
        way.param.update(options={**offered, **(FROM_FILE if has_weights else {})}, value=how)
        glue.visible = now is not None and now.how == "glued"
        if now is not None and now.joint is not None:
            offer(glue, unique_names(short_names(names)), names.index(now.joint))

    def changed(event: Any) -> None:
        one = _now(parts, chosen(state, memo))
        if one is None or event.new == ("" if one.correction is None else one.correction.how):
            return
        joint = state.rig.skeleton.names[one.joint] if event.new == "glued" else None
        _bind(session, one, PartCorrection(event.new, joint) if event.new else None)

    def glued(event: Any) -> None:
        one = _now(parts, chosen(state, memo))
        if one is None or one.correction is None or event.new is None:
            return
        joint = state.rig.skeleton.names[glue.options.index(event.new)]
        if one.correction.how == "glued" and joint != one.correction.joint:
            _bind(session, one, PartCorrection("glued", joint))

    way.param.watch(changed, "value")
    glue.param.watch(glued, "value")
    state.param.watch(lambda *events: session.tasks.later(show), WATCHED)
    # The colours go first.
    state.param.watch(lambda event: session.tasks.after_a_pause(show, "parts"), "binding")
    show()
    return whole


def _now(parts: list[Component], number: int) -> Component | None:
    return parts[number] if 0 <= number < len(parts) else None


def _choose(session: Session, one: Component) -> None:
    """Look at a component; at the same again, no more."""
    same = chosen(session.state, session.memo) == one.number
    session.state.part = None if same else one.first


def _bind(session: Session, one: Component, part: PartCorrection | None) -> None:
    vertices = vertices_of(session.state, session.memo, one.first)
    correct.correct_part(session, set(vertices.tolist()), part)


def _title(one: Component) -> str:
    name = f" · {one.name}" if one.name else ""
    return f"Part {one.number + 1}{name} · {one.vertices:,}"


def _follows(one: Component, names: tuple[str, ...]) -> str:
    """Say what a component follows."""
    joint = shown_name(names[one.joint])
    if one.correction is None:
        return f"{joint} {one.share:.0%}"
    how = SHORT[one.correction.how]
    return how if one.correction.how == "file" else f"{how}: {joint}"
