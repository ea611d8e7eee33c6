"""Results of the panel Distance: a bone's field, and other measures."""

from typing import Any

from cutcell_lab.baselines.measured_distance import measure_distance

from ...derive.derived import Derived
from ...document.session import Session
from ...document.state import State
from ...looks.character import has_field
from ...looks.measures import CONVERGED, method_of
from ...server.protocol.received import HaltWave
from ...server.protocol.sent import Wave
from .measures import WITH_RESOLUTION
from .scene import farthest, wants_field

WAVE_SECONDS = 6.0


def watch(session: Session) -> None:
    """Take over where the wavefront halts."""
    session.view.listen(HaltWave, lambda message: halt_wave(session, message.front))


def halt_wave(session: Session, front: float) -> None:
    """Take over where the wave halted in the browser, as a part of the greatest distance."""
    session.state.front = min(max(front, 0.0), 1.0)


def wave_part(state: State) -> Wave | None:
    """Return how far and how fast the wavefront runs in the browser; None where it does not."""
    if state.panel != "distance" or not (state.wave and state.animating):
        return None
    end = farthest(state)
    return None if end is None else {"end": end, "seconds": WAVE_SECONDS}


def _of_bone(state: State) -> tuple[Any, ...] | None:
    """Return the distances and the joint, where the chosen joint has any."""
    return (state.binding.distances, state.joint) if has_field(state) else None


def _measured_inputs(state: State, name: str) -> tuple[Any, ...] | None:
    bone, resolution = _of_bone(state), CONVERGED
    if bone is None:
        return None
    if name != "converged":
        resolution = state.beside_resolution if name in WITH_RESOLUTION else 0
    return *bone, name, resolution


RESULTS = (
    Derived(
        "field",
        _of_bone,
        lambda distances, joint, progress: distances.field(joint),
        wanted=wants_field,
    ),
    Derived(
        "measured",
        _measured_inputs,
        lambda distances, joint, name, resolution, rig, method, progress: measure_distance(
            rig, distances, joint, name, method
        ),
        parts=lambda state: state.measures,
        wanted=lambda state, name: state.panel == "distance",
        more=lambda state, name: (
            state.rig,
            method_of(state, CONVERGED if name == "converged" else state.beside_resolution),
        ),
        lane="measured",
        failed=lambda session, name: session.state.param.update(**{f"beside_{name}": False}),
    ),
)
