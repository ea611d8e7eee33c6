"""The scene that the page shows for some choices."""

from dataclasses import replace
from typing import Any

from cutcell import bind, build_graph, diagnose
from cutcell.errors import ParameterError
from cutcell.rig import Rig
from cutcell.runtime.progress import Progress, silent
from cutcell_viewers.description import Description
from cutcell_viewers.error_scene import Gap
from cutcell_viewers.materials import Textures, load_textures
from cutcell_viewers.pose_scene import pose_at

from ..commands.compare import measured
from ..commands.pose import motion_error
from ..scenes import following, resolve
from ..scenes.common import has_field
from ..scenes.distance import wants_field
from ..scenes.graph import build_shown
from ..scenes.measures import measuring
from ..scenes.sweep import sweep_scenes
from ..state import State
from .choices import Choices, state_of
from .names import find_clip


def describe(
    rig: Rig,
    choices: Choices | None = None,
    *,
    binding: Any = None,
    textures: Textures | None = None,
    resolution: int | None = None,
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
    resolution : int, optional
        For that, and of the graph that is shown; when left out, weights use 64 and the graph that
        is shown is easier to read.
    progress : callable
        See `cutcell.runtime.progress`.

    Returns
    -------
    Description
        For `cutcell_viewers.show`.

    Raises
    ------
    ParameterError
        No such panel, bone, axis or method; nothing to compare with.
    SkeletonError
        A mesh without a skeleton, on a panel that needs one.

    Examples
    --------
    >>> scene = describe(rig, Choices("weights", bone="hand.L"))  # doctest: +SKIP
    >>> cutcell_viewers.show(scene)  # doctest: +SKIP
    """
    choices = choices or Choices()
    state = _computed(rig, choices, binding, textures, resolution, progress)
    if choices.clip is None or state.bare:
        return resolve(state)
    clip = find_clip(rig, choices.clip)
    if choices.error and state.panel == "pose":
        gap = Gap(rig, state.binding.weights, rig.weights)  # type: ignore[arg-type]
        state.motion_error = (state.binding, state.motion, motion_error(rig, clip, gap, progress))
    time = choices.time or 0.0
    return replace(following(state), pose=pose_at(rig, clip, time))


def describe_sweep(
    rig: Rig,
    choices: Choices,
    rate: int,
    *,
    binding: Any = None,
    resolution: int | None = None,
    progress: Progress = silent,
) -> tuple[Description, ...]:
    """Return the scenes of a film of `choices.sweep`, for the `scenes` of a `film.Order`.

    Parameters
    ----------
    rig, choices, binding, resolution, progress
        As of `describe`.
    rate : int
        Frames a second.
    """
    state = _computed(rig, choices, binding, None, resolution, progress)
    return sweep_scenes(state.snapshot(), choices.sweep or "", rate, progress=progress)


def _computed(
    rig: Rig,
    choices: Choices,
    binding: Any,
    textures: Textures | None,
    resolution: int | None,
    progress: Progress,
) -> State:
    """Return the page's state with all that its scene shows computed."""
    state = state_of(rig, choices)
    if resolution is not None and "graph_resolution" not in choices.settings:
        state.graph_resolution = 0
    resolution = state.resolution = resolution or choices.method.resolution
    if choices.panel == "graph" and state.graph_inputs is not None:
        state.easy_graph = (state.graph_inputs, build_shown(state.graph_inputs, progress))
    if state.bare:
        state.bare_graph = build_graph(
            rig.mesh, resolution, method=choices.method, progress=progress
        )
    else:
        state.binding = binding or bind(rig, resolution, method=choices.method, progress=progress)
        state.materials = (rig.mesh, textures or textures_for(rig, choices))
    if state.panel == "check":
        state.diagnosis = diagnose(rig, resolution, progress=progress)
        state.finding = choices.finding or ""
        if state.finding and state.selected_finding is None:
            codes = ", ".join(one.code for one in state.diagnosis.findings) or "none at all"
            raise ParameterError(f'{rig.name} has no finding "{state.finding}"; there are {codes}')
    if state.bare:
        return state
    if wants_field(state):
        distances = state.binding.distances
        state.field = (distances, state.joint, distances.field(state.joint))
    if state.panel == "distance" and has_field(state) and state.measures:
        try:
            state.beside_resolution = resolution
        except ValueError:
            allowed = ", ".join(map(str, state.param.beside_resolution.objects))
            raise ParameterError(
                f"measures side by side are drawn at a resolution of {allowed}, not {resolution}"
            ) from None
        for name in state.measures:
            state.measured = {**state.measured, name: measuring(state, name)()}
    if state.panel == "compare":
        for name in state.methods:
            measure = measured(rig, name, state.binding, resolution, progress)
            state.compared = {**state.compared, name: measure}
    return state


def textures_for(rig: Rig, choices: Choices) -> Textures | None:
    """Return the materials of a rig's file, if these are chosen; `notes` say what is missing.

    Parameters
    ----------
    rig : Rig
    choices : Choices
    """
    chosen = choices.settings.get("pose_colors") == "materials"
    return load_textures(rig) if chosen and choices.panel == "pose" else None
