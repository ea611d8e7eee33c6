"""Choices of a scene, and the page's state for them."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

from cutcell import ANIMATION, Method
from cutcell.errors import ParameterError
from cutcell.io.materials.transfer import has_materials
from cutcell.rig import Rig
from cutcell.rig.checks import check_choice
from cutcell_lab.baselines import METHODS

from ..scenes.common import first_joint
from ..scenes.sweep import SWEEPS, has_cut
from ..state import PANELS, State
from ..state.compare import NOW, standard
from ..state.method import GRAPH, method_of
from ..state.weights import SHOWN
from .names import find_bone, find_clip
from .options import apply

RENDERED = tuple(panel.id for panel in PANELS.values() if panel.is_rendered)
"""The panels whose scenes can be rendered."""

VIEWS = {
    "three-quarter": (0.42, 0.16, 1.0),
    "front": (0.0, 0.06, 1.0),
    "left": (1.0, 0.06, 0.0),
    "right": (-1.0, 0.06, 0.0),
    "back": (0.0, 0.06, -1.0),
    "top": (0.0, 1.0, 0.02),
}
"""Directions of view; left and right are the character's own."""

TURN_AXES = ("x", "y", "z")


@dataclass(frozen=True)
class Choices:
    """Choices for showing a rig, as on the page.

    Parameters
    ----------
    panel : str
        One of `RENDERED`.
    bone : str, optional
        Whose weights, distance or graph field, or which bone turns.
    shown : str, optional
        On the panel "weights": "bone", "mix", "dominant", "count" or "difference".
    turn : (str, float), optional
        An axis and degrees, by which the bone turns.
    error : bool
        Colour by the error against the file's own weights.
    methods : sequence of str
        Side by side on the panel "compare": names in `cutcell_lab.baselines.METHODS`, or "now".
    settings : mapping
        Other choices of the page, by the names that its address has for them, such as
        `{"cut_axis": "z", "mesh_edges": True}`; `render.options.settings_of` makes them.
    method : Method
        How the graph is built and distances are measured.
    finding : str, optional
        The code of a finding of `cutcell.diagnose`, shown on the panel "check".
    clip : str, optional
        Name or number, from 1, of a motion of the rig, which poses it.
    time : float, optional
        Of that, only the pose at this second.
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


def check(rig: Rig, choices: Choices, view: str | None = None) -> None:
    """Raise an error for choices that a rig does not offer, before anything is computed.

    Parameters
    ----------
    rig : Rig
    choices : Choices
    view : str, optional
        One of `VIEWS`.

    Raises
    ------
    ParameterError
        No such panel, bone, axis, view or method; nothing to compare with.
    SkeletonError
        A mesh without a skeleton, on a panel that needs one.
    """
    state_of(rig, choices)
    if view is not None:
        check_choice("view", view, VIEWS)


def state_of(rig: Rig, choices: Choices) -> State:
    """Return the page's state with what is chosen; nothing is computed yet.

    Parameters
    ----------
    rig : Rig
    choices : Choices

    Raises
    ------
    ParameterError
        See `check`.
    """
    panel = check_choice("panel", choices.panel, RENDERED)
    if not PANELS[panel].works_without_skeleton:
        rig.require_joints()
    state = State(rig=rig, panel=panel, dark=choices.dark, skeleton=choices.skeleton)
    state.joint = first_joint(rig) if choices.bone is None else find_bone(rig, choices.bone)
    if choices.bone is not None:
        state.weights_shown = "bone"
    if choices.shown is not None:
        state.weights_shown = check_choice("shown", choices.shown, SHOWN)
    state.param.update(**method_of(choices.method, GRAPH))
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
    apply(state, choices.settings)
    if choices.sweep is not None:
        _check_sweep(state, choices)
    if state.pose_colors == "materials" and not has_materials(rig):
        raise ParameterError(f"the file of {rig.name} has no materials with colours of their own")
    return state


def _check_sweep(state: State, choices: Choices) -> None:
    """Raise an error for a sweep of what is not shown; show the wave."""
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


def _methods(rig: Rig, names: Sequence[str]) -> list[str]:
    for name in names:
        check_choice("method", name, [NOW, *METHODS])
    return list(names) or standard(rig)
