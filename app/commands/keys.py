"""What the keys do, and the buttons over the canvas."""

from cutcell.editing.corrections import Corrections

from ..scenes.common import first_joint
from ..state import PANELS, State
from ..state.corrections import applied, changes, news
from ..state.url import defaults
from . import brush, pairs
from .loading import revisit
from .session import Session


def watch(session: Session) -> None:
    """Obey the keys."""
    session.view.listen("act", lambda message: act(session, str(message.get("act"))))


def act(session: Session, name: str) -> None:
    """Do what a key or a button says."""
    state = session.state
    does = {
        "undo": lambda: revisit(session, session.history.undo()),
        "redo": lambda: revisit(session, session.history.redo()),
        "reset": lambda: reset(session),
        "rendered": lambda: state.param.update(rendered=not state.rendered),
        "play": lambda: play(state),
        "next": lambda: step(session, 1),
        "previous": lambda: step(session, -1),
        "parent": lambda: to_parent(state),
        "child": lambda: to_child(state),
        "brush": lambda: brush.turn_over(session),
        "brush away": lambda: brush.put_down(session),
        "brush larger": lambda: brush.resize(session, 1),
        "brush smaller": lambda: brush.resize(session, -1),
        "brush stronger": lambda: brush.strengthen(session, 1),
        "brush weaker": lambda: brush.strengthen(session, -1),
    }.get(name)
    if does is not None and state.rig is not None:
        does()


def reset(session: Session) -> None:
    """Choose what one begins with, at rest, on the panel that is open."""
    state = session.state
    first = {**defaults(state), "moving": False, "playing": False}
    rig = applied(state.own, Corrections())
    changed = {**changes(state, rig, Corrections()), **news(state, first)}
    state.param.update(**{**changed, "joint": first_joint(rig)})
    session.view.tell(home=True)


def play(state: State) -> None:
    """Play the motion, or halt it; on the panel where things move."""
    if state.bare:
        return
    if not state.moving or not PANELS[state.panel].poses:
        panel = state.panel if state.panel == "compare" else "pose"
        state.param.update(panel=panel, moving=True, playing=True)
    else:
        state.playing = not state.playing


def step(session: Session, count: int) -> None:
    """Choose the next joint of the list, or the one before; of an audit, the next pair."""
    state = session.state
    if state.panel == "pairs":
        pairs.step(session, count)
    elif not state.bare:
        state.joint = (state.joint + count) % len(state.rig.skeleton.names)


def to_parent(state: State) -> None:
    """Choose the joint that the chosen one hangs on."""
    above = -1 if state.bare else int(state.rig.skeleton.parents[state.joint])
    if above >= 0:
        state.joint = above


def to_child(state: State) -> None:
    """Choose the first joint that hangs on the chosen one."""
    below = [] if state.bare else state.rig.skeleton.children[state.joint]
    if len(below):
        state.joint = int(below[0])
