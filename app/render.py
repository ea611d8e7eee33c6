"""The page's scenes without the page: for `cutcell render`, and for notebooks."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from difflib import get_close_matches
from typing import Any

from cutcell import bind, build_graph
from cutcell.checks import check_choice, check_has_joints
from cutcell.errors import ParameterError
from cutcell.progress import Progress, silent
from cutcell.rig import Clip, Rig
from cutcell_viewers.description import Description
from cutcell_viewers.error_scene import Gap
from cutcell_viewers.film import Order
from cutcell_viewers.pose_scene import clip_in_scene, pose_at

from .commands.compare import measured
from .commands.pose import motion_error
from .scenes import following, resolve
from .scenes.common import first_joint
from .scenes.geodesics import wants_field
from .state import State
from .state.compare import NOW, standard
from .state.weights import SHOWN

PANELS = {
    "graph": "graph",
    "distance": "geodesics",
    "weights": "weights",
    "pose": "pose",
    "compare": "compare",
}
"""What panels are called here, and in the state."""

VIEWS = {
    "three-quarter": (0.42, 0.16, 1.0),
    "front": (0.0, 0.06, 1.0),
    "left": (1.0, 0.06, 0.0),
    "right": (-1.0, 0.06, 0.0),
    "back": (0.0, 0.06, -1.0),
    "top": (0.0, 1.0, 0.02),
}
"""Where one can look from; left and right are the character's own."""

TURN_AXES = ("x", "y", "z")


@dataclass(frozen=True)
class Choices:
    """What to show of a rig; each field is a choice of the page.

    Parameters
    ----------
    panel : str
        One of `PANELS`.
    bone : str, optional
        Whose weights, distance or graph field, or which bone turns.
    shown : str, optional
        On the panel "weights": "bone", "mix", "dominant", "count" or "difference".
    turn : (str, float), optional
        An axis and degrees, by which the bone turns.
    error : bool
        Colour by the error against the file's own weights.
    methods : sequence of str
        Side by side on the panel "compare": names in `cutcell.baselines.METHODS`, or "now".
    cut : str, optional
        "x", "y" or "z": what the body is cut across.
    clip : str, optional
        Name or number, from 1, of a motion of the rig, which poses it.
    time : float, optional
        Of that, only the pose at this second.
    skeleton, dark : bool
    """

    panel: str = "weights"
    bone: str | None = None
    shown: str | None = None
    turn: tuple[str, float] | None = None
    error: bool = False
    methods: Sequence[str] = ()
    cut: str | None = None
    clip: str | None = None
    time: float | None = None
    skeleton: bool = True
    dark: bool = False


def describe(
    rig: Rig,
    choices: Choices | None = None,
    *,
    binding: Any = None,
    resolution: int = 64,
    progress: Progress = silent,
) -> Description:
    """Return the scene that the page shows for some choices.

    Parameters
    ----------
    rig : Rig
    choices : Choices, optional
    binding : Binding, optional
        Of the rig; computed when left out.
    resolution : int
        For that.
    progress : callable
        See `cutcell.progress`.

    Returns
    -------
    Description
        For `cutcell_viewers.show`.

    Raises
    ------
    ParameterError
        No such panel, bone, axis or method; nothing to compare with.
    SkeletonError
        A mesh without a skeleton, on any panel but "graph".

    Examples
    --------
    >>> scene = describe(rig, Choices("weights", bone="hand.L"))  # doctest: +SKIP
    >>> cutcell_viewers.show(scene)  # doctest: +SKIP
    """
    choices = choices or Choices()
    state = _state(rig, choices)
    if state.bare:
        state.bare_graph = build_graph(rig.mesh, resolution, connectivity="any", progress=progress)
        return resolve(state)
    state.binding = bind(rig, resolution, progress=progress) if binding is None else binding
    if wants_field(state):
        distances = state.binding.distances
        state.field = (distances, state.joint, distances.field(state.joint))
    if state.panel == "compare":
        for name in state.methods:
            found = measured(rig, name, state.binding, resolution, progress)
            state.compared = {**state.compared, name: found}
    if choices.clip is None:
        return resolve(state)
    clip = find_clip(rig, choices.clip)
    if choices.error and state.panel == "pose":
        gap = Gap(rig, state.binding.weights, rig.weights)  # type: ignore[arg-type]
        state.motion_error = (state.binding, state.motion, motion_error(rig, clip, gap, progress))
    time = choices.time or 0.0
    return replace(following(state), pose=pose_at(rig, clip, time))


def check(rig: Rig, choices: Choices, view: str = "three-quarter") -> None:
    """Raise an error for choices that a rig does not offer, before anything is computed."""
    _state(rig, choices)
    check_choice("view", view, VIEWS)


def order(
    rig: Rig,
    description: Description,
    choices: Choices,
    *,
    size: tuple[int, int] = (1600, 1200),
    view: str = "three-quarter",
    turntable: bool = False,
    legend: bool = True,
) -> Order:
    """Return what is to be drawn: a picture, or a film where it turns or moves.

    Parameters
    ----------
    rig : Rig
    description : Description
        From `describe`, for the same choices.
    choices : Choices
    size : (int, int)
        Width and height in pixels.
    view : str
        One of `VIEWS`.
    turntable : bool
        The camera goes once around.
    legend : bool

    Raises
    ------
    ParameterError
        No such view.
    """
    direction = VIEWS[check_choice("view", view, VIEWS)]
    motion = None
    if choices.clip is not None and choices.time is None:
        clip = find_clip(rig, choices.clip)
        motion = clip_in_scene(rig, clip)
    theme = "dark" if choices.dark else "light"
    return Order(description, theme, size, None, direction, turntable, motion, legend)


def find_bone(rig: Rig, name: str) -> int:
    """Return the number of the joint of a name; the case of its letters does not matter.

    Raises
    ------
    ParameterError
        There is none; the sentence tells the names that are nearest.
    """
    return _find("bone", name, list(rig.skeleton.names), rig)


def find_clip(rig: Rig, name: str) -> Clip:
    """Return the clip of a name or number.

    Raises
    ------
    ParameterError
        There is none; the sentence tells those that there are.
    """
    if not rig.clips:
        raise ParameterError(f"{rig.name} has no clips to play")
    names = [clip.name for clip in rig.clips]
    if name not in names and name.isdecimal() and 1 <= int(name) <= len(names):
        return rig.clips[int(name) - 1]
    return rig.clips[_find("clip", name, names, rig)]


def _find(what: str, name: str, names: list[str], rig: Rig) -> int:
    if name in names:
        return names.index(name)
    folded = [one.casefold() for one in names]
    if folded.count(name.casefold()) == 1:
        return folded.index(name.casefold())
    near = get_close_matches(name.casefold(), folded, 3, 0.5)
    near += [one for one in folded if name.casefold() in one][: 3 - len(near)]
    found = [names[folded.index(one)] for one in dict.fromkeys(near)]
    few = found or names[:8]
    told = "the nearest names are" if found else "there are" if len(names) <= 8 else "some are"
    quoted = ", ".join(f'"{one}"' for one in few)
    raise ParameterError(f'{rig.name} has no {what} "{name}"; {told} {quoted}')


def _state(rig: Rig, choices: Choices) -> State:
    panel = PANELS[check_choice("panel", choices.panel, PANELS)]
    if panel != "graph":
        check_has_joints(rig.skeleton)
    state = State(rig=rig, panel=panel, dark=choices.dark, skeleton=choices.skeleton)
    state.joint = first_joint(rig) if choices.bone is None else find_bone(rig, choices.bone)
    if choices.bone is not None:
        state.weights_shown = "bone"
    if choices.shown is not None:
        state.weights_shown = check_choice("shown", choices.shown, SHOWN)
    if choices.cut is not None:
        state.cut_axis = check_choice("cut", choices.cut, TURN_AXES)
    if choices.turn is not None:
        axis, degrees = choices.turn
        k = TURN_AXES.index(check_choice("axis", axis, TURN_AXES))
        state.turns = {state.joint: tuple(degrees * float(i == k) for i in range(3))}
    if choices.error and rig.weights is None:
        raise ParameterError(f"{rig.name} has no weights of its own to tell an error against")
    if choices.clip is not None:
        clip = find_clip(rig, choices.clip)
        state.clip = next(k for k, one in enumerate(rig.clips) if one is clip)
        state.moving = True
    elif choices.time is not None:
        raise ParameterError("a time is one in a clip: name the clip, too")
    state.heat = choices.error
    state.compare_field = "error" if choices.error else "bone" if choices.bone else "all"
    state.methods = _methods(rig, choices.methods)
    return state


def _methods(rig: Rig, names: Sequence[str]) -> list[str]:
    from cutcell.baselines import METHODS

    for name in names:
        check_choice("method", name, [NOW, *METHODS])
    return list(names) or standard(rig)
