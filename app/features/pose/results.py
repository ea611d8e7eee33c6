"""Motions, turning by controller, and how far the two weightings are apart."""

from typing import Any

from cutcell.errors import CutcellError
from cutcell.pose import axis_rotation
from cutcell_viewers.error_scene import gap_between
from cutcell_viewers.pose_scene import clip_in_scene

from ...derive.derived import Derived
from ...document.session import Session
from ...document.state import State
from ...looks.pose import SWING, angles_of, clip_of, clip_part, rotation_of
from ...server.protocol.received import Play, Turn
from ...server.protocol.sent import Motion
from .errors import motion_error, scene_error
from .materials import MATERIALS
from .poses import STRETCHES
from .scene import has_rival

TURN_DEGREES = 30.0
"""How far a joint turns when a bad turn is looked at: as in the deformation error."""


def watch(session: Session) -> None:
    """Connect the rings and the play button of the view."""
    controller = RingController(session)
    session.view.listen(Turn, controller.turn)
    session.view.listen(Play, lambda message: session.state.param.update(playing=message.on))


def motion_part(state: State) -> Motion | None:
    """Return the motion that is on, or None; raise a `CutcellError` if it cannot be played."""
    clip = clip_of(state)
    # A swing is a new clip each time: it is named by the joint and the axis.
    inputs = (state.rig, state.motion, clip if state.clip != SWING else clip is None)
    part: Motion | None = state.memo("clip", inputs, lambda: clip_part(state, clip))
    return part


def is_playing(state: State) -> bool:
    """Return whether a motion runs in the browser."""
    try:
        return bool(state.playing and motion_part(state))
    except CutcellError:
        return False


class RingController:
    """Rotates joints as the rings on the canvas are dragged."""

    def __init__(self, session: Session) -> None:
        self._state = session.state
        self._last_turn = (0.0, 0.0, 0.0)

    def turn(self, message: Turn) -> None:
        """Turn a joint about one of its local axes, by the degrees since its ring was pressed."""
        state, joint = self._state, message.joint
        if state.rig is None or not 0 <= joint < len(state.rig.skeleton.joints):
            return
        now = state.turns.get(joint, (0.0, 0.0, 0.0))
        if message.begin:
            self._last_turn = now
        axis = "xyz"[message.axis]
        rotation = rotation_of(self._last_turn) @ axis_rotation(axis, message.degrees)
        turns = {**state.turns, joint: angles_of(rotation, now)}
        state.param.update(turns=turns, moving=False, playing=False)


def turn_joint(session: Session, axis: int, degrees: float) -> None:
    """Set one of the chosen joint's three angles."""
    state = session.state
    angles = list(state.turns.get(state.joint, (0.0, 0.0, 0.0)))
    if angles[axis] == degrees and not state.moving:
        return
    angles[axis] = degrees
    turns = {**state.turns, state.joint: tuple(angles)}
    state.param.update(turns=turns, moving=False, playing=False)


def show_turn(session: Session, joint: int, axis: str) -> None:
    """Show one of the worst turns: that joint alone, turned, and the error in colours."""
    angles = tuple(TURN_DEGREES * float(axis == one) for one in "xyz")
    session.state.param.update(
        joint=joint, axis=axis, turns={joint: angles}, moving=False, playing=False, heat=True
    )


def _both(state: State) -> tuple[Any, ...] | None:
    """Return the two weightings that are compared, where there are two."""
    return (state.rig, state.binding) if has_rival(state) else None


def _motion(state: State) -> tuple[Any, ...] | None:
    both, clip = _both(state), clip_of(state)
    if both is None or clip is None:
        return None
    return *both, state.blending, state.motion, None if state.clip == SWING else clip


RESULTS = (
    Derived(
        "errors",
        _both,
        lambda rig, binding, progress: scene_error(rig, binding.weights, rig.weights, progress),
        wanted=lambda state: state.panel == "pose",
    ),
    Derived(
        "motion_error",
        _motion,
        lambda rig, binding, blending, motion, clip, swung, progress: motion_error(
            clip_in_scene(rig, swung),
            gap_between(rig, binding.weights, rig.weights, blending),
            progress,
        ),
        wanted=lambda state: state.panel == "pose" and state.heat,
        more=lambda state: (clip_of(state),),
    ),
    MATERIALS,
    STRETCHES,
)
