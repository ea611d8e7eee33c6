"""Actions of the keys and of the buttons over the canvas."""

import numpy as np
from param.parameterized import batch_call_watchers

from cutcell_viewers.camera import FRONT

from ...document.address import defaults
from ...document.document import put
from ...document.framing import camera_on_bone, first_joint
from ...document.loading import travel
from ...document.look import set_camera
from ...document.session import Session
from ...document.state import State
from ...editing.brush import strokes as brush
from ...editing.select import actions as selecting
from ...features.learn.writing import save_view
from ...features.pairs import results as pairs
from ...messages.received import Act

NEAR = 0.3
"""How much is seen around a bone that is framed, at least, of the character's longest side."""


def watch(session: Session) -> None:
    """Connect the keys."""
    session.view.listen(Act, lambda message: act(session, message.act))


def act(session: Session, name: str) -> None:
    """Do what a key or a button says."""
    state = session.state
    does = {
        "undo": lambda: travel(session, -1),
        "redo": lambda: travel(session, 1),
        "reset": lambda: reset(session),
        "step": lambda: save_view(session),
        "rendered": lambda: state.param.update(rendered=not state.rendered),
        "play": lambda: play(state),
        "next": lambda: step(session, 1),
        "previous": lambda: step(session, -1),
        "frame": lambda: frame(session),
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
    elif state.rig is not None:
        selecting.act(session, name)


def reset(session: Session) -> None:
    """Choose what one begins with, at rest, on the panel that is open."""
    state = session.state
    first = {**defaults(state), "moving": False, "playing": False}
    with batch_call_watchers(state):
        put(state, **first)
        state.joint = first_joint(state.rig)
    session.view.send(home=True)


def play(state: State) -> None:
    """Play the motion, or halt it; on the panel where things move."""
    if state.bare:
        return
    if not state.moving or not state.open_panel.poses:
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


def frame(session: Session) -> None:
    """Look at the chosen bone, from the side that one looks from."""
    state, eye = session.state, session.view.camera
    if not state.bare:
        direction = FRONT if eye is None else tuple(np.subtract(eye.position, eye.focal_point))
        set_camera(session, camera_on_bone(state, NEAR, session.view.aspect, direction))


def to_parent(state: State) -> None:
    """Choose the parent of the chosen joint."""
    above = -1 if state.bare else int(state.rig.skeleton.parents[state.joint])
    if above >= 0:
        state.joint = above


def to_child(state: State) -> None:
    """Choose the first child of the chosen joint."""
    below = [] if state.bare else state.rig.skeleton.children[state.joint]
    if len(below):
        state.joint = int(below[0])
