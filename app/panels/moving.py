"""Where the chosen joint stands: its handle, numbers, the middle of the limb."""

from typing import Any

import numpy as np
from panel.io import hold

from cutcell.editing.corrections import JointCorrection
from cutcell.errors import ParameterError
from cutcell.rig import Rig
from cutcell.rig.checks import shown

from ..commands import moving
from ..commands.session import Session
from ..state import State
from .controls import BESIDE, button, caption, row, switch, text_box

NUMBER = "%.6g"
NOTHING = 1e-9
"""Coordinates below this, relative to the longest side, are shown as zero."""


def place(session: Session) -> list[Any]:
    """Return what moves the chosen joint."""
    state = session.state
    mirrored = switch(state.param.mirrored)
    narrow = {"& input": {"paddingX": "8px"}}
    fields = [
        text_box(axis.upper(), margin=(8, 6 * (axis != "z"), 4, 0), sx=narrow) for axis in "xyz"
    ]
    centre = button("Centre in limb", lambda: moving.centre(session), margin=BESIDE)
    back = button("Reset position", lambda: moving.put_back(session))
    showing = [False]

    def show() -> None:
        rig = state.rig if state.dragged is None else state.dragged.rig
        if rig is None or state.joint >= len(rig.skeleton.names):
            return
        showing[0] = True
        try:
            place = rig.skeleton.joints[state.joint].tolist()
            with hold():  # one message for all three: each alone keeps a dragged joint waiting
                for field, value in zip(fields, place, strict=True):
                    field.value = _written(rig, value)
            mirrored.visible = moving.partner_of(session) is not None
            back.disabled = _moved(state) is None
        finally:
            showing[0] = False

    def written(event: Any, axis: int) -> None:
        if showing[0] or state.rig is None:
            return
        at: list[Any] = state.rig.skeleton.joints[state.joint].tolist()
        if event.new == _written(state.rig, at[axis]):
            return
        try:
            at[axis] = float(event.new)
        except ValueError:
            session.fail(ParameterError(f"{'XYZ'[axis]} must be a number, not {shown(event.new)}"))
            show()
            return
        moving.put(session, at)

    for axis, field in enumerate(fields):
        field.param.watch(lambda event, axis=axis: written(event, axis), "value")
    state.param.watch(lambda *events: show(), ["rig", "joint", "corrections", "dragged"])
    show()
    return [
        caption("Position (file units)", margin=(8, 0, 0, 0)),
        row(*fields),
        switch(state.param.joint_handle),
        mirrored,
        row(centre, back),
    ]


def _written(rig: Rig, value: float) -> str:
    """Return a coordinate; what is nothing beside the mesh is zero."""
    extent = float(np.ptp(rig.mesh.bounds, axis=0).max())
    return NUMBER % (value if abs(value) > NOTHING * extent else 0.0)


def _moved(state: State) -> Any:
    """Return where the chosen joint was put, or None; what was added was put nowhere else."""
    name = state.rig.skeleton.names[state.joint]
    one = state.corrections.joints.get(name, JointCorrection())
    return None if one.added else one.position
