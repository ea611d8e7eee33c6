"""The joints as a tree: which carry weight, keep the file's, and how far each reaches."""

from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np

from cutcell.editing import JointEdit
from cutcell.rig.deform_joints import DeformJoints
from cutcell.runtime.display import shown_name

from ...document.session import Session
from ...document.state import State
from ...widgets import controls as ui
from ...widgets.joint_tree import JointTree
from ..compute.stack import locked_names
from . import commands as correct
from .joints import joint_rows, shares_of
from .moving_controls import PLACE
from .structure_controls import STRUCTURE

AS_COMPUTED: dict[str, Any] = {"deform": None, "locked": False, "gain": 1.0, "radius": None}
DOUBLINGS = 2.0
"""The slider goes from as many halvings of a joint's reach to as many doublings."""


def _tree(session: Session) -> JointTree:
    """Return the tree of joints, which asks for a guess about each character that it shows."""
    cache: dict[str, Any] = {"of": None, "guess": None}

    def guessed(of: Any, guess: DeformJoints) -> None:
        if of == _character(session.state):  # otherwise another one was opened meanwhile
            cache["guess"] = guess
            tree.rows = joint_rows(session.state, guess)

    def shows(state: State) -> dict[str, Any]:
        if state.rig is None or state.bare:
            return {}
        of = _character(state)
        if cache["of"] != of:
            cache.update(of=of, guess=None)
            correct.guess(session, partial(guessed, of))
        rows = joint_rows(state, cache["guess"])
        return {"rows": rows, "chosen": state.joint}

    row = ui.Control(
        JointTree, act=_clicked, shows=shows, late=("binding",), margin=ui.GAP, **ui.WIDE
    )
    tree: JointTree = ui.draw(session, row, "weights")
    return tree


def _clicked(session: Session, clicked: tuple[int, bool | None]) -> None:
    joint, deform = clicked
    if deform is None:
        session.state.joint = joint
    else:
        correct.correct_joint(session, joint, deform=deform)


def _detect(session: Session) -> None:
    """Choose the joints that a guess takes to deform the mesh."""
    of = _character(session.state)

    def choose(guess: DeformJoints) -> None:
        if _character(session.state) == of:
            correct.choose_deform(session, np.flatnonzero(guess.deform))

    correct.guess(session, choose)


def _character(state: State) -> Any:
    """Return a key of the character that edits of weights do not change."""
    return state.rig and (state.rig.mesh, state.rig.skeleton.names)


def _edit(state: State) -> JointEdit:
    """Return the edit of the chosen joint."""
    if not ui.has_joint(state):
        return JointEdit()
    name = state.rig.skeleton.names[state.joint]
    return state.edits.joints.get(name, JointEdit())


def _corrects(name: str, read: Any = lambda value: value) -> Any:
    """Return an action that sets an edit of the chosen joint."""
    return lambda session, value: correct.correct_joint(
        session, session.state.joint, **{name: read(value)}
    )


def _is_as_computed(state: State) -> bool:
    """Return whether all that is edited of the chosen joint is the skeleton's structure."""
    one = _edit(state)
    position = one.position if one.added else None
    if one != replace(one, deform=None, position=position):
        return False
    return not _is_locked(state) and (_gain(state), _radius(state)) == (1.0, "")


def _is_locked(state: State) -> bool:
    return _name(state) in locked_names(state.edits)


def _gain(state: State) -> float:
    return float(state.edits.reach.gain.get(_name(state), 1.0))


def _reset(session: Session) -> None:
    """Reset the edits of the chosen joint; a joint that was added keeps its position."""
    position = {} if _edit(session.state).added else {"position": None}
    correct.correct_joint(session, session.state.joint, **AS_COMPUTED, **position)


def _name(state: State) -> str:
    return state.rig.skeleton.names[state.joint] if ui.has_joint(state) else ""


def _rename(session: Session, name: str) -> None:
    if name.strip() == _name(session.state):
        session.state.param.trigger("edits")  # reset the field to the name without spaces
    else:
        correct.rename(session, session.state.joint, name)


def _is_from_file(state: State) -> bool:
    """Return whether the reach of joints changes nothing: the base is the file's weights."""
    return bool(state.edits.base == "file")


def _reach(gain: float) -> float:
    return float(np.clip(round(float(np.log2(gain)), 1), -DOUBLINGS, DOUBLINGS))


def _read_number(text: str) -> Any:
    """Return the number that a text says; None for none, the text where it is no number."""
    try:
        return float(text) if text.strip() else None
    except ValueError:
        return text


def _radius(state: State) -> str:
    radius = state.edits.reach.radius.get(_name(state))
    return "" if radius is None else f"{radius:g}"


def _weight_text(state: State) -> str:
    """Say how much of the skin the chosen joint holds."""
    if not ui.has_joint(state):
        return ""
    computed, original = shares_of(state)
    lines = []
    if computed is not None:
        lines.append(f"Moves {_percent(computed[state.joint])} of the skin")
    if original is not None:
        lines.append(f"{_percent(original[state.joint])} in the file")
    text = ", ".join(lines)
    return text[:1].upper() + text[1:] + "." if text else ""


def _percent(part: float) -> str:
    return f"{100 * part:.2g} %" if 0 < part < 0.0995 else f"{part:.0%}".replace("%", " %")


def _counted(state: State) -> str:
    if state.rig is None:
        return ""
    chosen = state.rig.skeleton.deform
    if chosen.all():
        return f"All {len(chosen)} joints deform the mesh."
    return f"{chosen.sum()} of {len(chosen)} joints deform the mesh."


JOINTS = ui.folded(
    "Joints",
    ui.caption(_counted),
    _tree,
    ui.button(
        "Detect deforming joints", _detect, variant="text", margin=0, sizing_mode=None,
        description="Detect deforming joints by name and position",
    ),
    ui.text_line(
        lambda state: shown_name(_name(state)),
        sx={"fontWeight": 600, "fontSize": 13},
        margin=(6, 0, 0, 0),
    ),
    ui.caption(_weight_text, margin=0, late=("binding",)),
    ui.text_box("Name", act=_rename, value=_name),
    STRUCTURE,
    ui.switch(
        "",
        label="Deforms the mesh",
        act=_corrects("deform"),
        value=lambda state: ui.has_joint(state) and not ui.weightless(state),
        margin=(2, 0),
    ),
    ui.switch(
        "",
        label="Lock to file weights",
        act=_corrects("locked"),
        value=_is_locked,
        disabled=lambda state: not ui.has_weights(state),
        margin=(2, 0),
    ),
    ui.slider(
        "",
        label=lambda state: f"Reach ×{_gain(state):.2f}",
        act=_corrects("gain", lambda reach: round(float(2.0**reach), 3)),
        value=lambda state: _reach(_gain(state)),
        start=-DOUBLINGS, end=DOUBLINGS, step=0.1, show_value=False, track=False, tooltips=False,
        disabled=_is_from_file,
    ),
    ui.text_box(
        "Radius (file units)",
        act=_corrects("radius", _read_number),
        value=_radius,
        placeholder="measured from the body",
        visible=lambda state: state.falloff != "paper",
        disabled=_is_from_file,
    ),
    PLACE,
    ui.button("Reset", _reset, icon="undo", disabled=_is_as_computed),
)  # fmt: skip
