"""Position of the chosen joint: its handle, numbers, the middle of the limb."""

from typing import Any

import numpy as np

from cutcell.checks import shown
from cutcell.editing import JointEdit
from cutcell.errors import ParameterError
from cutcell.rig import Rig

from ...document.session import Session
from ...document.state import State
from ...widgets import controls as ui
from . import moving

NUMBER = "%.6g"
NOTHING = 1e-9
"""Coordinates below this, relative to the longest side, are shown as zero."""
NARROW = {"& input": {"paddingX": "8px"}}


def _written(rig: Rig, value: float) -> str:
    """Return a coordinate; what is nothing beside the mesh is zero."""
    extent = float(np.ptp(rig.mesh.bounds, axis=0).max())
    return NUMBER % (value if abs(value) > NOTHING * extent else 0.0)


def _moved(state: State) -> Any:
    """Return where the chosen joint was put, or None; what was added was put nowhere else."""
    name = state.rig.skeleton.names[state.joint]
    one = state.edits.joints.get(name, JointEdit())
    return None if one.added else one.position


def _coordinate(axis: int) -> Any:
    """Return the field of one of the chosen joint's coordinates."""

    def value(state: State) -> str:
        rig = state.rig if state.dragged is None else state.dragged.rig
        if rig is None or state.joint >= len(rig.skeleton.names):
            return ""
        return _written(rig, float(rig.skeleton.joints[state.joint, axis]))

    def put(session: Session, text: str) -> None:
        state = session.state
        if state.rig is None:
            return
        at: list[Any] = state.rig.skeleton.joints[state.joint].tolist()
        try:
            at[axis] = float(text)
        except ValueError:
            session.refuse(ParameterError(f"{'XYZ'[axis]} must be a number, not {shown(text)}"))
            return
        moving.put(session, at)

    margin = (8, 6 * (axis < 2), 4, 0)
    return ui.text_box("XYZ"[axis], act=put, value=value, margin=margin, sx=NARROW)


def _has_partner(state: State) -> bool:
    return ui.has_joint(state) and moving.partner_of(state) is not None


def _is_in_place(state: State) -> bool:
    return not ui.has_joint(state) or _moved(state) is None


PLACE = (
    ui.caption("Position (file units)", margin=(8, 0, 0, 0)),
    ui.row([_coordinate(axis) for axis in range(3)]),
    ui.switch("joint_handle"),
    ui.switch("mirrored", visible=_has_partner),
    ui.row(
        ui.button("Centre in limb", moving.centre, margin=ui.BESIDE),
        ui.button("Reset position", moving.put_back, disabled=_is_in_place),
    ),
)
"""Rows: what moves the chosen joint."""
