"""The page's scenes without the page: for `cutcell render`, and for notebooks."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from cutcell import ANIMATION, Method, bind, build_graph, diagnose
from cutcell.checks import check_choice, check_has_joints, check_number
from cutcell.errors import ParameterError
from cutcell.io.materials import has_materials
from cutcell.progress import Progress, silent
from cutcell.rig import Rig
from cutcell_viewers.camera import Camera, framing
from cutcell_viewers.character import drawn_segments
from cutcell_viewers.description import Description
from cutcell_viewers.error_scene import Gap
from cutcell_viewers.film import Order
from cutcell_viewers.finding_scene import camera_on_marks
from cutcell_viewers.materials import Textures, load_textures
from cutcell_viewers.pose_scene import clip_in_scene, pose_at

from .commands.compare import measured
from .commands.pose import motion_error
from .render_names import find_bone, find_clip
from .render_options import apply, settings_of
from .scenes import following, resolve
from .scenes.common import first_joint, has_field
from .scenes.geodesics import wants_field
from .scenes.measures import measuring
from .state import State
from .state.compare import NOW, standard
from .state.weights import SHOWN

__all__ = [
    "PANELS",
    "VIEWS",
    "Choices",
    "check",
    "describe",
    "find_bone",
    "find_clip",
    "order",
    "settings_of",
    "textures_for",
]

PANELS = {
    "graph": "graph",
    "distance": "geodesics",
    "weights": "weights",
    "pose": "pose",
    "compare": "compare",
    "check": "diagnosis",
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
    settings : mapping
        Other choices of the page, by the names that its address has for them, such as
        `{"cut_axis": "z", "mesh_edges": True}`; `render_options.settings_of` makes them.
    method : Method
        How the graph is built and distances are measured.
    finding : str, optional
        The code of a finding of `cutcell.diagnose`, shown on the panel "check".
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
    settings: Mapping[str, Any] = field(default_factory=dict)
    method: Method = ANIMATION
    finding: str | None = None
    clip: str | None = None
    time: float | None = None
    skeleton: bool = True
    dark: bool = False


def describe(
    rig: Rig,
    choices: Choices | None = None,
    *,
    binding: Any = None,
    textures: Textures | None = None,
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
    textures : Textures, optional
        What shows it in its file's materials, where these are chosen; read when left out.
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
        state.bare_graph = build_graph(
            rig.mesh, resolution, method=choices.method, progress=progress
        )
        return resolve(state)
    if binding is None:
        binding = bind(rig, resolution, method=choices.method, progress=progress)
    state.binding = binding
    state.materials = (rig.mesh, textures or textures_for(rig, choices))
    if state.panel == "diagnosis":
        state.diagnosis = diagnose(rig, resolution, progress=progress)
        state.finding = choices.finding or ""
        if state.finding and state.found is None:
            there = ", ".join(one.code for one in state.diagnosis.findings) or "none at all"
            raise ParameterError(f'{rig.name} has no finding "{state.finding}"; there are {there}')
    if wants_field(state):
        distances = state.binding.distances
        state.field = (distances, state.joint, distances.field(state.joint))
    if state.panel == "geodesics" and has_field(state) and state.measures:
        try:
            state.beside_resolution = resolution
        except ValueError:
            known = ", ".join(map(str, state.param.beside_resolution.objects))
            raise ParameterError(
                f"measures side by side are drawn at a resolution of {known}, not {resolution}"
            ) from None
        for name in state.measures:
            state.measured = {**state.measured, name: measuring(state, name)()}
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


def textures_for(rig: Rig, choices: Choices) -> Textures | None:
    """Return the materials of a rig's file, if these are chosen; `notes` say what is missing.

    Parameters
    ----------
    rig : Rig
    choices : Choices
    """
    chosen = choices.settings.get("pose_colors") == "materials"
    return load_textures(rig) if chosen and choices.panel == "pose" else None


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
    near: float | None = None,
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
    near : float, optional
        How much is seen around the bone, in parts of the longest side.

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
    aspect = size[0] / size[1]
    camera = camera_on_marks(description, aspect) if choices.finding else None
    if near is not None:
        camera = _near(
            rig, description, choices, check_number("near", near, 0.01, 1), aspect, direction
        )
    return Order(description, theme, size, camera, direction, turntable, motion, legend)


def _near(
    rig: Rig,
    description: Description,
    choices: Choices,
    part: float,
    aspect: float,
    direction: tuple[float, float, float],
) -> Camera:
    """Return a camera that looks at the middle of the chosen bone, at rest."""
    start, end, of = drawn_segments(rig)
    own = of == (first_joint(rig) if choices.bone is None else find_bone(rig, choices.bone))
    ends = np.concatenate([start[own], end[own]]) if own.any() else description.bounds
    half = part / 2 * float(np.ptp(description.bounds, axis=0).max())
    middle = ends.mean(axis=0)
    return framing(np.stack([middle - half, middle + half]), aspect, direction)


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
    method = choices.method
    state.param.update(
        connectivity=method.connectivity,
        winding_threshold=method.winding_threshold,
        orient=method.orient,
    )
    apply(state, choices.settings)
    if state.pose_colors == "materials" and not has_materials(rig):
        raise ParameterError(f"the file of {rig.name} has no materials with colours of their own")
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
