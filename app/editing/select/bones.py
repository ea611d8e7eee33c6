"""Swap bones, or replace some by others: at the selection, or in the whole rig."""

from collections.abc import Callable

import numpy as np

from cutcell.editing import Remapped
from cutcell.errors import CutcellError, ParameterError
from cutcell_viewers.short_names import short_names

from ...document.selection import selected
from ...document.session import Session
from ...document.state import State
from ...widgets import controls as ui
from ..compute.joint_table import EXAMPLE, branch_pairs, read_table, swapped
from ..correct.commands import check_alone
from ..layers.commands import put_content

ABOUT = "At the selection, or in the whole rig. The result is a layer."


def remap(session: Session, table: Callable[[], dict[int, int]], name: str) -> None:
    """Put a layer that moves weight from joints to others, over the selection or everything."""
    state = session.state
    chosen, names = selected(state), state.rig.skeleton.names
    try:
        joints = table()
        for joint in {*joints, *joints.values()}:
            check_alone(state.rig.skeleton, joint)
        content = Remapped({names[one]: names[other] for one, other in joints.items()})
    except CutcellError as error:
        session.fail(error)
        return
    vertices = None if chosen is None else np.flatnonzero(chosen)
    put_content(session, vertices, lambda: content, name=name, deform=content.joints.values())


def other_bone(state: State) -> int | None:
    """Return the joint that the chosen one is exchanged with; None for none."""
    names = state.rig.skeleton.names if ui.has_joint(state) else ()
    return names.index(state.other_bone) if state.other_bone in names else None


def _pairs(state: State) -> dict[int, int]:
    other = other_bone(state)
    if other is None or other == state.joint:
        raise ParameterError("choose another bone to swap the selected one with")
    if not state.with_children:
        return {state.joint: other}
    return branch_pairs(state.rig.skeleton, state.joint, other)


def swap(session: Session) -> None:
    """Exchange the weights of the chosen joint and another one."""
    remap(session, lambda: swapped(_pairs(session.state)), f"Swap {_title(session.state)}")


def replace_bone(session: Session) -> None:
    """Give the weight of the chosen joint to another one."""
    remap(session, lambda: _pairs(session.state), f"Replace {_title(session.state)}")


def replace_by_table(session: Session, text: str) -> None:
    """Move weight by a table that a person wrote."""
    session.state.bone_table = text.strip()
    if text.strip():
        remap(session, lambda: read_table(text, session.state.rig.skeleton), "Replace by table")


def _title(state: State) -> str:
    other = other_bone(state)
    names = [
        ui.joint_title(state.rig, joint) for joint in (state.joint, other) if joint is not None
    ]
    return ", ".join(names)


def _label(verb: str, between: str) -> Callable[[State], str]:
    def label(state: State) -> str:
        if not ui.has_joint(state):
            return verb
        other = other_bone(state)
        second = "another bone" if other is None else ui.joint_title(state.rig, other)
        return f"{verb} {ui.joint_title(state.rig, state.joint)} {between} {second}"

    return label


def _bones(state: State) -> list[str]:
    names = short_names(state.rig.skeleton.names) if ui.has_joint(state) else []
    return ["None", *names]


def _choose_other(session: Session, place: int) -> None:
    names = session.state.rig.skeleton.names
    session.state.other_bone = names[place - 1] if place else ""


def _place(state: State) -> int:
    other = other_bone(state)
    return 0 if other is None else other + 1


def _is_alone(state: State) -> bool:
    return other_bone(state) in (None, state.joint)


BONES = ui.folded(
    "Swap and replace bones",
    ui.caption(ABOUT),
    ui.pick("Other bone", _bones, _place, _choose_other, searchable=True, margin=(10, 0, 4, 0)),
    ui.switch("with_children"),
    ui.button(_label("Swap", "with"), swap, icon="swap_horiz", disabled=_is_alone),
    ui.button(_label("Replace", "by"), replace_bone, icon="arrow_forward", disabled=_is_alone),
    ui.text_box(
        "Replace by table",
        act=replace_by_table,
        value=lambda state: state.bone_table,
        placeholder=EXAMPLE,
        repeats=True,
    ),
    visible=lambda state: state.binding is not None,
)
