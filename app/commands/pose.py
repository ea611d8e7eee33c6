"""Motions, turning by hand, and how far the two weightings are apart."""

from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from cutcell.errors import CutcellError
from cutcell.rig import Clip, Rig, Skeleton, TriangleMesh
from cutcell.runtime.progress import Progress, silent
from cutcell_lab.metrics import DeformationError, deformation_error
from cutcell_viewers.character import to_scene
from cutcell_viewers.error_scene import WHOLE, Gap
from cutcell_viewers.pose_scene import pose_at, turn

from ..scenes.pose import (
    angles_of,
    clip_of,
    clip_part,
    gap_of,
    gizmo_part,
    has_rival,
    rotation_of,
)
from .session import Session

TURN_DEGREES = 30.0
"""How far a joint turns when a bad turn is looked at: as in the deformation error."""
FRAMES = 24
"""How many frames of a motion the error is measured at."""


def watch(session: Session) -> None:
    """Keep motion, gizmo and errors up to what is chosen."""
    follow = session.state.param.watch
    follow(
        lambda *events: tell_motion(session),
        ["panel", "rig", "moving", "playing", "clip", "joint", "axis"],
    )
    follow(lambda *events: tell_gizmo(session), ["panel", "rig", "moving", "joint", "brush"])
    follow(lambda *events: find_errors(session), ["panel", "binding"])
    follow(
        lambda *events: find_motion_error(session),
        ["panel", "binding", "moving", "clip", "joint", "axis", "heat"],
    )
    hand = Hand(session)
    session.view.listen("turn", hand.turn)
    session.view.listen("play", lambda data: session.state.param.update(playing=bool(data["on"])))


def tell_motion(session: Session) -> None:
    """Send the motion that is on, if it is another one, and whether it plays."""
    state = session.state
    clip = clip_of(state)
    inputs = (state.rig, clip is None, state.motion)
    try:
        part = session.memo("clip", inputs, lambda: clip_part(state, clip))
    except CutcellError as error:  # the clip cannot be played
        part = None
        session.fail(error)
    session.view.send(clip=part, playing=state.playing and part is not None)


def tell_gizmo(session: Session) -> None:
    """Send where the rings are that turn the chosen joint."""
    session.view.send(gizmo=gizmo_part(session.state))


class Hand:
    """Slots joints as the rings on the canvas are dragged.

    Parameters
    ----------
    session : Session
    """

    def __init__(self, session: Session) -> None:
        self._state = session.state
        self._last_turn = (0.0, 0.0, 0.0)

    def turn(self, data: dict[str, Any]) -> None:
        """Turn a joint about one of its local axes.

        Parameters
        ----------
        data : dict
            The number of the "joint", of the "axis", the "degrees" since it was taken hold
            of, and "begin" where that was just now.
        """
        state, joint = self._state, int(data["joint"])
        if state.rig is None or not 0 <= joint < len(state.rig.skeleton.joints):
            return
        now = state.turns.get(joint, (0.0, 0.0, 0.0))
        if data.get("begin"):
            self._last_turn = now
        axis = "xyz"[int(data["axis"])]
        rotation = rotation_of(self._last_turn) @ turn(axis, float(data["degrees"]))
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


def rest(session: Session) -> None:
    """Put the character back as it was in the file."""
    session.state.param.update(turns={}, moving=False, playing=False)


def play(session: Session) -> None:
    """Start the chosen motion, or halt it."""
    state = session.state
    state.param.update(moving=True, playing=not (state.moving and state.playing))


def find_errors(session: Session) -> None:
    """Measure which turns part the two weightings most, once the panel is looked at."""
    state = session.state
    rig, binding = state.rig, state.binding
    if state.panel != "pose" or not has_rival(state):
        session.tasks.jobs("errors").cancel()  # nobody looks at it: others may compute
        return
    if state.errors is not None and state.errors[0] is binding:
        return

    def work(progress: Progress) -> Any:
        return scene_error(rig, binding.weights, rig.weights, progress)

    def done(errors: Any) -> None:
        if state.binding is binding:
            state.errors = (binding, errors)

    session.tasks.jobs("errors").start(work, done, session.fail, lambda stage, fraction: None)


def find_motion_error(session: Session) -> None:
    """Measure how far the weightings are apart over the motion, once colours tell of it."""
    state = session.state
    clip, motion, binding, rig = clip_of(state), state.motion, state.binding, state.rig
    if state.panel != "pose" or clip is None or not state.heat or not has_rival(state):
        session.tasks.jobs("motion error").cancel()
        return
    error = state.motion_error
    if error is not None and error[0] is binding and error[1] == motion:
        return
    gap = gap_of(state, session.memo)

    def work(progress: Progress) -> Any:
        return motion_error(rig, clip, gap, progress)

    def done(error: Any) -> None:
        if state.binding is binding:
            state.motion_error = (binding, motion, error)

    session.tasks.jobs("motion error").start(work, done, session.fail, lambda stage, fraction: None)


def motion_error(
    rig: Rig, clip: Clip, gap: Gap, progress: Progress = silent
) -> tuple[float, float, float]:
    """Return the distances between two sets of weights over a motion, in mm.

    Returns
    -------
    rms : float
    greatest : float
    most : float
        What nearly all vertices stay below, in every frame.
    """
    times = clip.times
    frames = np.unique(np.linspace(0, len(times) - 1, FRAMES).round().astype(int))
    squares = greatest = most = 0.0
    for done, frame in enumerate(frames[frames >= 0]):
        progress("error", done / len(frames))
        lengths = gap.lengths(pose_at(rig, clip, times[frame]))
        squares += float(np.square(lengths).mean()) / len(frames)
        greatest = max(greatest, float(lengths.max()))
        most = max(most, float(np.quantile(lengths, WHOLE)))
    return float(np.sqrt(squares)), greatest, most


def scene_error(
    rig: Rig, weights: ArrayLike, reference: ArrayLike, progress: Progress = silent
) -> DeformationError:
    """Return the deformation error with turns about the scene's axes, as the page turns joints."""
    mesh = TriangleMesh(to_scene(rig, rig.mesh.vertices), rig.mesh.faces)
    skeleton = rig.skeleton
    joints = to_scene(rig, skeleton.joints)
    parts = (mesh, Skeleton(joints, skeleton.parents, skeleton.names, skeleton.deform))
    return deformation_error(parts, weights, reference, progress=progress)
