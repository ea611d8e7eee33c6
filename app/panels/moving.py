"""Where the chosen joint stands: its handle, numbers, the middle of the limb."""

from __future__ import annotations

from typing import Any

import panel_material_ui as pmui
from panel.io import hold

from cutcell.editing.corrections import JointCorrection
from cutcell.errors import ParameterError
from cutcell.rig.checks import shown

from ..commands import moving
from ..commands.session import Session
from ..state import State
from .controls import caption

NUMBER = "%.6g"


def place(session: Session) -> list[Any]:
    """Return what moves the chosen joint."""
    state = session.state
    style: dict[str, Any] = {"size": "small", "margin": (3, 0), "description": ""}
    handle, mirrored = (
        pmui.Switch.from_param(parameter, label=parameter.label, **style)
        for parameter in (state.param.joint_handle, state.param.mirrored)
    )
    fields = [
        pmui.TextInput(
            label=axis.upper(), value="", size="small", margin=(8, 6 * (axis != "z"), 4, 0),
            sizing_mode="stretch_width", sx={"& input": {"paddingX": "8px"}},
        )
        for axis in "xyz"
    ]  # fmt: skip
    centre, back = (
        pmui.Button(
            label=label, size="small", variant="outlined", margin=(4, margin, 4, 0),
            sizing_mode="stretch_width", on_click=lambda event, act=act: act(session),
        )
        for label, act, margin in (
            ("Centre in limb", moving.centre, 8), ("Reset position", moving.put_back, 0),
        )
    )  # fmt: skip
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
                    field.value = NUMBER % value
            mirrored.visible = moving.partner_of(session) is not None
            back.disabled = _moved(state) is None
        finally:
            showing[0] = False

    def written(event: Any, axis: int) -> None:
        if showing[0] or state.rig is None:
            return
        at: list[Any] = state.rig.skeleton.joints[state.joint].tolist()
        if event.new == NUMBER % at[axis]:
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
        pmui.Row(*fields, margin=0, sizing_mode="stretch_width"),
        handle,
        mirrored,
        pmui.Row(centre, back, margin=0, sizing_mode="stretch_width"),
    ]


def _moved(state: State) -> Any:
    """Return where the chosen joint was put, or None; what was added was put nowhere else."""
    name = state.rig.skeleton.names[state.joint]
    one = state.corrections.joints.get(name, JointCorrection())
    return None if one.added else one.position
