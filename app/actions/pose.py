"""Tell the browser which motion to play."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ..scenes.pose import clip_of, clip_part

if TYPE_CHECKING:
    from ..session import Session


def watch(session: Session) -> None:
    """Keep the motion up to what is chosen."""
    session.state.param.watch(
        lambda *events: tell_motion(session),
        ["panel", "rig", "moving", "playing", "clip", "joint", "axis"],
    )


def tell_motion(session: Session) -> None:
    """Send the motion that is on, if it is another one, and whether it plays."""
    state = session.state
    swings = f"{state.joint} {state.axis}" if state.clip < 0 else ""
    clip = clip_of(state)
    inputs = (state.rig, clip is None, state.clip, swings)
    part = session.memo("clip", inputs, lambda: clip_part(state, clip))
    session.view.tell(clip=part, playing=state.playing and part is not None)
