"""Parts of the mesh: each glued to a joint, following the body, or bound by itself."""

from typing import Any

from cutcell.editing import Attached, Computed, Filled, FromFile
from cutcell.runtime.display import shown_name
from cutcell_viewers.short_names import short_names

from ...document.session import Session
from ...document.state import State
from ...looks.components import chosen, vertices_of
from ...widgets import controls as ui
from ...widgets.rows import Rows
from . import commands as correct
from .components import MOST, Component, listed

WAYS = {
    "As below": "",
    "Rigid, to one joint": "filled",
    "With the body it touches": "attached",
    "Separately": "computed",
}
FROM_FILE = {"As in the file": "file"}
SHORT = {"filled": "rigid", "attached": "follows", "computed": "separate", "file": "original"}
CONTENTS = {"attached": Attached(), "computed": Computed(as_skin=True), "file": FromFile()}
LATE = ("binding",)


def _parts(state: State) -> list[Component]:
    """Return the connected components."""
    inputs = (state.rig, state.binding, state.edits)
    parts: list[Component] = state.memo("parts", inputs, lambda: listed(state))
    return parts


def _chosen(state: State) -> Component | None:
    """Return the component that is looked at."""
    number, parts = chosen(state), _parts(state)
    return parts[number] if 0 <= number < len(parts) else None


def _how(state: State) -> str:
    """Return how the chosen component is bound; empty where it has no layer."""
    one = _chosen(state)
    return "" if one is None or one.layer is None else one.layer.content.kind


def _about(state: State) -> str:
    count = len(_parts(state))
    more = " The largest are listed." if count == MOST else ""
    return f"{count} separate parts. Click to isolate one, again to show all.{more}"


def _list(state: State) -> dict[str, Any]:
    """Return the rows of the components, and the number of the chosen one."""
    parts = _parts(state)
    names = state.rig.skeleton.names if parts else ()
    rows = [(_title(one), _follows(one, names), one.vertices / parts[0].vertices) for one in parts]
    return {"rows": rows, "chosen": chosen(state)}


def _title(one: Component) -> str:
    name = f" · {one.name}" if one.name else ""
    return f"Part {one.number + 1}{name} · {one.vertices:,}"


def _follows(one: Component, names: tuple[str, ...]) -> str:
    """Return the joint that a component follows, and how."""
    joint = shown_name(names[one.joint])
    if one.layer is None:
        return f"{joint} {one.share:.0%}"
    kind = one.layer.content.kind
    return SHORT[kind] if kind == "file" else f"{SHORT[kind]}: {joint}"


def _look(session: Session, number: int) -> None:
    """Look at a component; at the same one again, at all."""
    state = session.state
    same = chosen(state) == number
    state.part = None if same else listed(state)[number].first


def _ways(state: State) -> dict[str, Any]:
    """Return how the component that is looked at can be bound, and how it is."""
    one, how = _chosen(state), _how(state)
    is_body = one is None or not one.number  # the largest one
    ways = {t: way for t, way in WAYS.items() if way != "attached" or not is_body or way == how}
    options = {**ways, **(FROM_FILE if ui.has_weights(state) else {})}
    return {"options": options, "value": how, "visible": one is not None}


def _bind(session: Session, how: Any, joint: int | None = None) -> None:
    """Bind the component that is looked at, rigidly to the joint that it follows by default."""
    state, one = session.state, _chosen(session.state)
    if one is None:
        return
    name = state.rig.skeleton.names[one.joint if joint is None else joint]
    content = Filled({name: 1.0}) if how == "filled" else CONTENTS.get(how)
    vertices = vertices_of(state, one.first)
    correct.correct_part(session, set(vertices.tolist()), content)


def _rigid_to(state: State) -> int:
    """Return the joint that the component that is looked at is rigid to."""
    one: Any = _chosen(state)
    weights = one.layer.content.weights
    return int(state.rig.skeleton.names.index(max(weights, key=weights.get)))


COMPONENTS = ui.folded(
    "Parts of the mesh",
    ui.caption(_about, late=LATE),
    ui.column(
        ui.Control(
            Rows, act=_look, shows=_list, late=LATE, label="Parts of the mesh",
            styles={"--bar": "var(--mui-palette-text-secondary, #667)"}, **ui.FULL,
        ),
        margin=ui.GAP, max_height=200, scroll="y",
    ),
    ui.select("", "Bind this part", act=_bind, shows=_ways, late=LATE, margin=(16, 0, 4, 0)),
    ui.pick(
        "Joint",
        lambda state: short_names(state.rig.skeleton.names) if _how(state) == "filled" else [],
        _rigid_to,
        lambda session, joint: _bind(session, "filled", joint),
        late=LATE, visible=lambda state: _how(state) == "filled", margin=(12, 0, 4, 0),
        searchable=True,
    ),
    needed=lambda state: state.part is not None,
    visible=lambda state: len(_parts(state)) > 1,
    late=LATE,
)  # fmt: skip
