"""Compute a bone's whole field when it is to be seen."""

from __future__ import annotations

from typing import Any

from cutcell.progress import Progress
from cutcell_viewers.distance_scene import distance_limits

from ..scenes.geodesics import field_of, wants_field
from .session import Session

WAVE_SECONDS = 6.0
SHOWN = ["panel", "binding", "joint", "edge_colors", "vertex", "cut_axis", "graph_face"]
"""What a field's being wanted depends on."""


def watch(session: Session) -> None:
    """Keep the field up to what is seen."""
    session.state.param.watch(lambda *events: find_field(session), SHOWN)
    session.view.listen("front", lambda message: halt_wave(session, message["front"]))
    session.state.param.watch(
        lambda *events: run_wave(session), ["panel", "wave", "animating", "field", "joint", "rig"]
    )


def halt_wave(session: Session, front: float | None) -> None:
    """Take over where the wave halted in the browser, as a part of the greatest distance."""
    session.state.front = min(max(front or 0.0, 0.0), 1.0)


def run_wave(session: Session) -> None:
    """Let the wavefront run in the browser, or halt it; told only when it is another one."""
    state = session.state
    field = field_of(state)
    runs = state.panel == "geodesics" and state.wave and state.animating and field is not None
    animation = {"end": distance_limits(field)[1], "seconds": WAVE_SECONDS} if runs else None
    if session.view.told("animation") != animation:
        session.view.tell(animation=animation)


def find_field(session: Session) -> None:
    """Compute the chosen bone's distance at every node, where it is wanted and not there."""
    state = session.state
    joint = state.joint
    if not wants_field(state) or field_of(state) is not None:
        return
    distances = state.binding.distances

    def work(progress: Progress) -> Any:
        return distances.field(joint)

    def done(field: Any) -> None:
        state.field = (distances, joint, field)

    session.tasks.jobs("field").start(work, done, session.fail, lambda stage, fraction: None)
