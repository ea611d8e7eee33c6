"""Saved poses: part of the edits, each with the edge that stretches most, as in each clip."""

from dataclasses import replace
from typing import Any

from cutcell.editing import SavedPose
from cutcell.errors import CutcellError, ParameterError
from cutcell.runtime.display import listed, shown_name

from ...derive.derived import Derived
from ...document.look import pick_vertex
from ...document.session import Session
from ...document.state import State
from ...editing.correct.commands import check_alone, correct
from ...looks.pose import POSES, SWING, clip_names, saved_turns
from .stretches import Key, Worst, worst_edges

FILES, NOW = "file", "now"
"""The weights of the file, and those of the page."""


def save(session: Session, name: str) -> None:
    """Save the pose, or the frame of a clip, by a name, in place of one that has it already."""
    state, name = session.state, name.strip()
    if not name:
        return
    try:
        pose = _pose_now(state, session.view.time)
    except CutcellError as error:
        session.fail(error)
        return
    session.history.part()
    correct(session, replace(state.edits, poses={**state.edits.poses, name: pose}))
    if name in state.edits.poses:  # it is not where other edits were refused
        show(session, name)


def _pose_now(state: State, seconds: float) -> SavedPose:
    """Return what the character does now."""
    names = state.rig.skeleton.names
    if state.moving and state.clip >= 0:
        duration = state.rig.clips[state.clip].duration
        if seconds > duration > 0:
            seconds %= duration
        return SavedPose(clip=clip_names(state.rig)[state.clip], seconds=round(seconds, 3))
    turned = {joint: turn for joint, turn in state.turns.items() if any(turn)}
    if state.moving or not turned:
        raise ParameterError("turn a joint, or pause a clip of the file, to save a pose")
    for joint in turned:
        check_alone(state.rig.skeleton, joint)
    return SavedPose({names[joint]: turn for joint, turn in turned.items()})


def rename(session: Session, name: str) -> None:
    """Call the chosen pose otherwise."""
    state, name = session.state, name.strip()
    poses, old = state.edits.poses, state.pose_name
    if not name or name == old or old not in poses:
        return
    if name in poses:
        session.fail(ParameterError(f'another pose is called "{name}"; choose another name'))
        return
    session.history.part()
    renamed = {name if key == old else key: pose for key, pose in poses.items()}
    correct(session, replace(state.edits, poses=renamed))
    state.pose_name = name


def delete(session: Session) -> None:
    """Delete the chosen pose."""
    edits, name = session.state.edits, session.state.pose_name
    rest = {key: pose for key, pose in edits.poses.items() if key != name}
    session.history.part()
    correct(session, replace(edits, poses=rest))


def show(session: Session, key: Key) -> None:
    """Show a saved pose, or a clip, paused where an edge stretches most."""
    state = session.state
    if isinstance(key, str):
        pose = state.edits.poses[key]
        state.pose_name = key
        if pose.clip is None:
            turns = saved_turns(state.rig, pose)
            state.param.update(turns=turns, moving=False, playing=False)
        elif pose.clip in (names := clip_names(state.rig)):
            _halt(session, names.index(pose.clip), pose.seconds)
        return
    worst = worst_of(state, NOW, key)
    state.pose_name = ""
    _halt(session, key, 0.0 if worst is None else worst.seconds)


def _halt(session: Session, clip: int, seconds: float) -> None:
    """Show a frame of a clip."""
    session.state.param.update(clip=clip, moving=True, playing=False)
    session.view.time = seconds
    session.view.answer(time=seconds)


def show_worst(session: Session) -> None:
    """Choose the vertex where what is shown stretches most."""
    worst = worst_shown(session.state)
    if worst is not None:
        pick_vertex(session, worst.vertex)


def worst_shown(state: State) -> Worst | None:
    """Return where the saved pose or clip that is shown stretches most, if it was measured."""
    key = shown_key(state)
    return None if key is None else worst_of(state, NOW, key)


def worst_of(state: State, weights: str, key: Key) -> Worst | None:
    """Return where a pose or clip stretches most by the weights, if it was measured."""
    of_kind = state.stretches.get((weights, isinstance(key, int)), {})
    worst: Worst | None = of_kind.get(key)
    return worst


def keys(state: State) -> list[Key]:
    """Return the saved poses and clips, the one that stretches most first."""
    if state.rig is None:
        return []
    worst = {
        key: worst_of(state, NOW, key) for key in (*state.edits.poses, *range(len(state.rig.clips)))
    }
    return sorted(worst, key=lambda key: -one.factor if (one := worst[key]) else 0.0)


def shown_key(state: State) -> Key | None:
    """Return the saved pose or the clip that the character shows, or None."""
    pose = state.edits.poses.get(state.pose_name)
    if state.moving:
        if state.clip < 0:
            return None
        is_frame = pose is not None and pose.clip == clip_names(state.rig)[state.clip]
        return state.pose_name if is_frame and not state.playing else state.clip
    turned = {joint: turn for joint, turn in state.turns.items() if any(turn)}
    is_shown = pose is not None and pose.clip is None and saved_turns(state.rig, pose) == turned
    return state.pose_name if is_shown else None


def motions(state: State) -> dict[int, str]:
    """Return the motions to choose from: clips of the file, the saved poses, a swing."""
    names = dict(enumerate(() if state.rig is None else clip_names(state.rig)))
    if state.edits.poses:
        names[POSES] = "Saved poses"
    return {**names, SWING: "Swing the bone"}


def missing(state: State) -> str:
    """Name the joints and clips of saved poses that the character does not have."""
    if state.rig is None:
        return ""
    poses = state.edits.poses.values()
    joints = {joint for pose in poses for joint in pose.turns} - {*state.rig.skeleton.names}
    clips = {pose.clip for pose in poses if pose.clip is not None} - {*clip_names(state.rig)}
    absent = listed([shown_name(name) for name in (*sorted(joints), *sorted(clips))])
    return f"Saved poses name what this character lacks: {absent}." if absent else ""


def _inputs(state: State, part: tuple[str, bool]) -> tuple[Any, ...] | None:
    weights, is_clip = part
    binding = None if weights == FILES else state.binding
    if state.rig is None or not (state.rig.clips if is_clip else state.edits.poses):
        return None
    if (state.rig.weights if weights == FILES else binding) is None:
        return None
    return state.rig, binding, state.blending, None if is_clip else state.edits.poses


STRETCHES = Derived(
    "stretches",
    _inputs,
    lambda rig, binding, blending, poses, progress: worst_edges(
        rig, rig.weights if binding is None else binding.weights, blending, poses, progress
    ),
    wanted=lambda state, part: state.panel == "pose",
    parts=lambda state: [
        (weights, is_clip) for weights in (FILES, NOW) for is_clip in (False, True)
    ],
    pause=lambda old, new: old is not None,
    keeps=lambda old, new: old[0].mesh is new[0].mesh,
)
