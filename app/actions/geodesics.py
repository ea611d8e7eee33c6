"""Compute a bone's whole field when it is to be seen."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from cutcell.progress import Progress

from ..scenes.geodesics import field_of, wants_field

if TYPE_CHECKING:
    from ..session import Session


def watch(session: Session) -> None:
    """Keep the field up to what is seen."""
    session.state.param.watch(
        lambda *events: find_field(session), ["panel", "binding", "joint", "cut_axis"]
    )


def find_field(session: Session) -> None:
    """Compute the chosen bone's distance at every node, where it is wanted and not there."""
    state = session.state
    binding, joint = state.binding, state.joint
    if not wants_field(state) or field_of(state) is not None:
        return

    def work(progress: Progress) -> Any:
        return binding.distances.field(joint)

    def done(field: Any) -> None:
        state.field = (binding, joint, field)

    session.jobs("field").start(work, done, session.fail, lambda stage, fraction: None)
