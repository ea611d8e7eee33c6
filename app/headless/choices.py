"""Choices of a scene, and the page's state for them."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import param

from cutcell import ANIMATION, Method
from cutcell.checks import check_choice, check_number
from cutcell.errors import ParameterError
from cutcell.io.materials.transfer import has_materials
from cutcell.rig import Rig
from cutcell_lab.baselines import METHODS

from ..document.framing import first_joint
from ..document.method import GRAPH, method_of
from ..document.side_by_side import NOW, listed, standard
from ..document.state import State
from ..features.state import PANELS, PageState
from ..shell.session.sweep import SWEEPS, has_cut
from .names import bone_index, clip_index

RENDERED = tuple(name for name, panel in PANELS.items() if panel.is_rendered)
"""The panels whose scenes can be rendered."""

TURN_AXES = ("x", "y", "z")


@dataclass(frozen=True)
class Choices:
    """Choices for showing a rig, as on the page.

    Parameters
    ----------
    panel : str
        One of `RENDERED`.
    bone : str, optional
        The bone of weights, distances and turns.
    shown : str, optional
        On the panel "weights": "bone", "mix", "dominant", "count", "difference" or
        "symmetry".
    turn : (str, float), optional
        An axis and degrees, by which the bone turns.
    error : bool
        Colour by the error against the file's own weights.
    methods : sequence of str
        Side by side on the panel "compare": names in `cutcell_lab.baselines.METHODS`, or "now".
    settings : mapping
        Other choices of the page, by their names in its address, such as
        `{"cut_axis": "z", "mesh_edges": True}`.
    method : Method
        The method of the graph and of distances.
    finding : str, optional
        The code of a finding of `cutcell.diagnose`, shown on the panel "check".
    clip : str, optional
        Name or number, from 1, of a motion of the rig, which poses it.
    time : float, optional
        A moment of the clip in seconds, to show only its pose.
    sweep : str, optional
        For a film: "wave" or "cut", which runs from 0 to 1.
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
    sweep: str | None = None
    skeleton: bool = True
    dark: bool = False


def state_of(rig: Rig, choices: Choices) -> State:
    """Return the page's state for some choices, without any result yet.

    Raises
    ------
    ParameterError
        No such panel, bone, axis or method; nothing to compare with.
    SkeletonError
        A mesh without a skeleton, on a panel that needs one.
    """
    panel = check_choice("panel", choices.panel, RENDERED)
    if not PANELS[panel].works_without_skeleton:
        rig.require_joints()
    if choices.error and rig.weights is None:
        raise ParameterError(f"{rig.name} has no weights of its own to compare with")
    bone, clip = choices.bone, choices.clip
    if clip is None and choices.time is not None:
        raise ParameterError("a time is one in a clip: name the clip, too")
    state = PageState(rig=rig, panel=panel, dark=choices.dark, skeleton=choices.skeleton)
    state.joint = first_joint(rig) if bone is None else bone_index(rig, bone)
    state.param.update(
        **method_of(choices.method, GRAPH),
        heat=choices.error,
        compare_field="error" if choices.error else "bone" if bone else "all",
        methods=[
            check_choice("method", name, [NOW, *METHODS, *listed(rig, choices.methods)])
            for name in choices.methods
        ]
        or standard(rig),
    )
    if choices.shown is not None or bone is not None:
        state.weights_shown = check_choice(
            "shown", choices.shown or "bone", state.param.weights_shown.objects
        )
    if choices.turn is not None:
        axis, degrees = choices.turn
        k = TURN_AXES.index(check_choice("axis", axis, TURN_AXES))
        state.turns = {state.joint: tuple(degrees * float(i == k) for i in range(3))}
    if clip is not None:
        state.param.update(clip=clip_index(rig, clip), moving=True)
    _apply(state, choices.settings)
    if choices.sweep is not None:
        _check_sweep(state, choices)
    if state.pose_colors == "materials" and not has_materials(rig):
        raise ParameterError(f"the file of {rig.name} has no materials with colours of their own")
    return state


def _apply(state: State, settings: Mapping[str, Any]) -> None:
    """Set choices of the page; raise a `ParameterError` for those that it does not have."""
    for name, value in settings.items():
        if name not in state.param or name == "name":
            raise ParameterError(f'the page has no choice "{name}"')
        parameter = state.param[name]
        if isinstance(parameter, param.Selector):
            check_choice(name, value, parameter.objects)
        elif isinstance(parameter, param.Number):
            low, high = parameter.bounds or (None, None)
            if low is not None and high is not None:
                check_number(name, value, low, high)
        try:
            setattr(state, name, value)
        except ValueError:
            raise ParameterError(f'{name} cannot be "{value}"') from None
    count = 0 if state.rig is None else len(state.rig.mesh.vertices)
    if state.vertex is not None and not 0 <= state.vertex < count:
        raise ParameterError(f"vertex must be one of 0 to {count - 1}, not {state.vertex}")


def _check_sweep(state: State, choices: Choices) -> None:
    """Raise an error for a sweep of something that is not shown; show the wave."""
    name = check_choice("sweep", choices.sweep, SWEEPS)
    if choices.clip is not None:
        raise ParameterError("a film follows a clip or a sweep: leave one of them out")
    if name == "cut" and not has_cut(state):
        raise ParameterError(
            "there is no cut to move: add --cut x, y or z, on the panel graph or distance"
        )
    if name == "wave":
        if state.panel != "distance":
            raise ParameterError("the wave is on the panel distance: add --panel distance")
        if not state.rig.skeleton.deform[state.joint]:
            bone = state.rig.skeleton.names[state.joint]
            raise ParameterError(f'no wave begins at "{bone}", which moves nothing: choose another')
        state.wave = True
