"""The joints as a tree: which carry weight, keep the file's, and how far each reaches."""

from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np
import panel_material_ui as pmui
from panel_material_ui.widgets.base import MaterialWidget

from cutcell.editing.corrections import JointCorrection
from cutcell.rig.deform_joints import DeformJoints
from cutcell.runtime.display import shown_name

from ..commands import correct
from ..commands.session import Session
from ..scenes.joints import joint_rows, shares_of
from ..state import State
from ..widgets.joint_tree import JointTree
from .controls import CONTROL, GAP, as_text, button, caption, folded, text_box, text_line, when
from .moving import place
from .structure import structure

_AS_COMPUTED = {"deform": None, "locked": False, "gain": 1.0, "radius": None}
DOUBLINGS = 2.0
"""The slider goes from as many halvings of a joint's reach to as many doublings."""
STEP = 0.1


def joints(session: Session) -> pmui.Column:
    """Return the section with the tree of joints, and what can be corrected of the chosen one."""
    state = session.state
    tree = JointTree(
        lambda joint: _choose(state, joint),
        lambda joint, on: correct.correct_joint(session, joint, deform=on),
        sizing_mode="stretch_width",
        margin=GAP,
    )
    cache: dict[str, Any] = {"of": None, "guess": None}

    def guessed(of: Any, guess: DeformJoints) -> None:
        if cache["of"] == of:  # otherwise another character was opened meanwhile
            cache["guess"] = guess
            listed()

    def listed(*events: Any) -> None:
        rig = state.rig
        if rig is None or state.bare or state.panel != "weights":
            return  # it is shown when somebody looks
        of = _character(state)
        if cache["of"] != of:
            cache.update(of=of, guess=None)
            correct.guess(session, partial(guessed, of))
        tree.param.update(rows=joint_rows(state, session.memo, cache["guess"]), chosen=state.joint)

    def anew(event: Any) -> None:
        of = _character(state)

        def choose(guess: DeformJoints) -> None:
            if _character(state) == of:
                correct.choose_deform(session, np.flatnonzero(guess.deform))

        correct.guess(session, choose)

    state.param.watch(lambda *events: session.tasks.later(listed), ["panel", "rig", "corrections"])
    # The colours go first, while a slider moves all the time.
    state.param.watch(lambda event: session.tasks.after_a_pause(listed, "joints"), "binding")
    state.param.watch(lambda *events: tree.param.update(chosen=state.joint), "joint")
    listed()
    counts = caption(when(_counted, state.param.rig))
    guesser = pmui.Button(
        label="Detect deforming joints", size="small", variant="text", margin=0, on_click=anew,
        description="Detect deforming joints by name and position",
    )  # fmt: skip
    return folded("Joints", counts, tree, guesser, *_chosen(session))


def _character(state: State) -> Any:
    """Return what stays the same while a character's weights are corrected."""
    return state.rig and (state.rig.mesh, state.rig.skeleton.names)


def _choose(state: State, joint: int) -> None:
    state.joint = joint


def _chosen(session: Session) -> list[Any]:
    """Return what can be corrected of the chosen joint."""
    state = session.state
    heading = text_line("", sx={"fontWeight": 600, "fontSize": 13}, margin=(6, 0, 0, 0))
    holds = caption("", margin=0)
    called = text_box("Name")
    carries = _switch("Deforms the mesh")
    locked = _switch("Lock to file weights")
    gain = pmui.FloatSlider(
        label="Reach", start=-DOUBLINGS, end=DOUBLINGS, step=STEP, value=0.0,
        show_value=False, track=False, tooltips=False, **CONTROL,
    )  # fmt: skip
    radius = text_box("Radius (file units)", placeholder="measured from the body")
    reset = button("Reset", lambda: changes(**_AS_COMPUTED, **_put_back(state)), icon="undo")
    showing = [False]

    def update() -> None:
        holds.object = as_text(_weight_text(session))

    def show() -> None:
        rig = state.rig
        if rig is None or state.joint >= len(rig.skeleton.names):
            return
        name = rig.skeleton.names[state.joint]
        one = state.corrections.joints.get(name, JointCorrection())
        heading.object = as_text(shown_name(name))
        update()
        showing[0] = True
        try:
            called.value = name
            carries.value = bool(rig.skeleton.deform[state.joint])
            locked.param.update(value=one.locked, disabled=rig.weights is None)
            gain.label = f"Reach ×{one.gain:.2f}"
            if abs(gain.value - _doublings(one.gain)) > STEP / 2:
                # Not for what rounds to the same: it would take back what was pressed meanwhile.
                gain.value = _doublings(one.gain)
            radius.param.update(value=_written(one.radius), visible=state.falloff != "paper")
            reset.disabled = one == replace(JointCorrection(), **_structure(one))
        finally:
            showing[0] = False

    def changes(**values: Any) -> None:
        if not showing[0] and state.rig is not None:
            correct.correct_joint(session, state.joint, **values)

    def reached(event: Any) -> None:
        changes(gain=round(float(2.0**event.new), 3))

    def rename(event: Any) -> None:
        if not showing[0] and state.rig is not None:
            correct.rename(session, state.joint, event.new)
            show()

    called.param.watch(rename, "value")
    carries.param.watch(lambda event: changes(deform=event.new), "value")
    locked.param.watch(lambda event: changes(locked=event.new), "value")
    gain.param.watch(reached, "value")
    radius.param.watch(lambda event: changes(radius=_read(event.new)), "value")
    state.param.watch(lambda *events: show(), ["rig", "joint", "corrections", "falloff"])
    state.param.watch(lambda event: session.tasks.after_a_pause(update, "held"), "binding")
    show()
    controls = [heading, holds, called, structure(session), carries, locked, gain, radius]
    return [*controls, *place(session), reset]


def _structure(one: JointCorrection) -> dict[str, Any]:
    """Return what makes a correction one of the skeleton's structure, and is no other."""
    origin = {"parent": one.parent, "was": one.was, "added": one.added}
    return {**origin, "position": one.position} if one.added else origin


def _put_back(state: State) -> dict[str, Any]:
    """Return where the chosen joint stands as computed: what was added stays where it was put."""
    name = state.rig.skeleton.names[state.joint]
    added = state.corrections.joints.get(name, JointCorrection()).added
    return {} if added else {"position": None}


def _written(radius: float | None) -> str:
    return "" if radius is None else f"{radius:g}"


def _read(text: str) -> Any:
    """Return the number that a text says; None for none, the text where it is no number."""
    try:
        return float(text) if text.strip() else None
    except ValueError:
        return text


def _switch(label: str) -> MaterialWidget:
    return pmui.Switch(label=label, size="small", margin=(2, 0), description="")


def _doublings(gain: float) -> float:
    return float(np.clip(round(float(np.log2(gain)), 1), -DOUBLINGS, DOUBLINGS))


def _weight_text(session: Session) -> str:
    """Say how much of the skin the chosen joint holds."""
    state = session.state
    computed, original = shares_of(state, session.memo)
    lines = []
    if computed is not None:
        lines.append(f"Moves {_percent(computed[state.joint])} of the skin")
    if original is not None:
        lines.append(f"{_percent(original[state.joint])} in the file")
    text = ", ".join(lines)
    return text[:1].upper() + text[1:] + "." if text else ""


def _percent(part: float) -> str:
    return f"{100 * part:.2g} %" if 0 < part < 0.0995 else f"{part:.0%}".replace("%", " %")


def _counted(rig: Any) -> str:
    if rig is None:
        return ""
    chosen = rig.skeleton.deform
    if chosen.all():
        return f"All {len(chosen)} joints deform the mesh."
    return f"{chosen.sum()} of {len(chosen)} joints deform the mesh."
