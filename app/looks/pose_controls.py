"""Controls of a motion: play it, and rest."""

from ..document.session import Session
from ..widgets import controls as ui


def rest(session: Session) -> None:
    """Put the character back as it was in the file."""
    session.state.param.update(turns={}, moving=False, playing=False)


def play(session: Session) -> None:
    """Start the chosen motion, or halt it."""
    state = session.state
    state.param.update(moving=True, playing=not (state.moving and state.playing))


REST = ui.button("Rest pose", rest, disabled=lambda s: not s.posed)
