"""The scene that the page shows for some choices."""

from dataclasses import replace
from typing import Any, cast

from cutcell import bind, build_graph
from cutcell.errors import ParameterError
from cutcell.pose import pose_at
from cutcell.rig import Rig
from cutcell.runtime.progress import Progress, silent
from cutcell_viewers.character import pose_in_scene
from cutcell_viewers.description import Description
from cutcell_viewers.materials import Textures, load_textures

from ..derive.derived import ComputedWhenRead
from ..document.state import State
from ..features import results
from ..features.scenes import following, resolve
from ..shell.session.sweep import sweep_scenes
from .choices import Choices, state_of
from .names import clip_named


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
        Its file's materials, where these are chosen; read when left out.
    resolution : int, optional
        Of the binding and of the graph that is shown. Default: 64 for weights, and a graph that is
        easier to read.
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
    pose = pose_at(clip_named(rig, choices.clip), choices.time or 0.0)
    return replace(following(state), pose=pose_in_scene(rig, pose))


def describe_sweep(
    rig: Rig,
    choices: Choices,
    rate: int,
    *,
    binding: Any = None,
    resolution: int | None = None,
    progress: Progress = silent,
) -> tuple[Description, ...]:
    """Return the scenes of a film of `choices.sweep`, at a rate of frames per second."""
    state = _computed(rig, choices, binding, None, resolution, progress)
    return sweep_scenes(state, choices.sweep or "", rate, progress=progress)


def _computed(
    rig: Rig,
    choices: Choices,
    binding: Any,
    textures: Textures | None,
    resolution: int | None,
    progress: Progress,
) -> State:
    """Return the page's state, whose results are computed when its scene reads them."""
    state = state_of(rig, choices)
    if resolution is not None and "graph_resolution" not in choices.settings:
        state.graph_resolution = 0
    resolution = state.resolution = resolution or choices.method.resolution
    if state.bare:
        state.built_graph = build_graph(
            rig.mesh, resolution, method=choices.method, progress=progress
        )
    else:
        state.binding = binding or bind(rig, resolution, method=choices.method, progress=progress)
        state.materials = textures or textures_for(rig, choices)
    state.finding = choices.finding or ""
    try:
        state.beside_resolution = resolution
    except ValueError:
        if state.panel == "distance" and state.measures:
            allowed = ", ".join(map(str, state.param.beside_resolution.objects))
            raise ParameterError(
                f"measures side by side are drawn at a resolution of {allowed}, not {resolution}"
            ) from None
    computed = cast(State, ComputedWhenRead(state, results(), progress))
    if choices.finding and computed.selected_finding is None:
        codes = ", ".join(one.code for one in computed.diagnosis.findings) or "none at all"
        raise ParameterError(f'{rig.name} has no finding "{state.finding}"; there are {codes}')
    return computed


def textures_for(rig: Rig, choices: Choices) -> Textures | None:
    """Return the materials of a rig's file, if they are chosen; `notes` list what is missing."""
    chosen = choices.settings.get("pose_colors") == "materials"
    return load_textures(rig) if chosen and choices.panel == "pose" else None
