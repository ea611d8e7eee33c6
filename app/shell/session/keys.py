"""Actions of the keys and of the buttons over the canvas."""

from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np
from param.parameterized import batch_call_watchers

from cutcell_viewers.camera import FRONT

from ...document.address import defaults
from ...document.document import put
from ...document.framing import camera_on_bone, first_joint
from ...document.loading import travel
from ...document.look import set_camera
from ...document.session import Session
from ...features import FEATURES
from ...looks.pose import play
from ...server.protocol.received import Act

NEAR = 0.3
"""How much is seen around a bone that is framed, at least, of the character's longest side."""


def watch(session: Session) -> None:
    """Connect the keys."""
    session.view.listen(Act, lambda message: act(session, message.act))


def act(session: Session, name: str) -> None:
    """Run the action of a key or a button."""
    of_panel = FEATURES[session.state.panel].keys
    action = of_panel.get(name) or KEYS.get(name)
    if action is not None and session.state.rig is not None:
        action(session)


def reset(session: Session) -> None:
    """Reset all choices to their defaults, at rest, on the open panel."""
    state = session.state
    first = {**defaults(state), "moving": False, "playing": False}
    with batch_call_watchers(state):
        put(state, **first)
        state.joint = first_joint(state.rig)
    session.view.send(home=True)


def step(session: Session, count: int) -> None:
    """Choose the next joint of the list, or the one before."""
    state = session.state
    if not state.bare:
        state.joint = (state.joint + count) % len(state.rig.skeleton.names)


def frame(session: Session) -> None:
    """Look at the chosen bone, from the side that one looks from."""
    state, eye = session.state, session.view.camera
    if not state.bare:
        direction = FRONT if eye is None else tuple(np.subtract(eye.position, eye.focal_point))
        set_camera(session, camera_on_bone(state, NEAR, session.view.aspect, direction))


def to_parent(session: Session) -> None:
    """Choose the parent of the chosen joint."""
    state = session.state
    above = -1 if state.bare else int(state.rig.skeleton.parents[state.joint])
    if above >= 0:
        state.joint = above


def to_child(session: Session) -> None:
    """Choose the first child of the chosen joint."""
    state = session.state
    below = [] if state.bare else state.rig.skeleton.children[state.joint]
    if len(below):
        state.joint = int(below[0])


def toggle_rendered(session: Session) -> None:
    """Let the server draw the view, or the browser again."""
    session.state.rendered = not session.state.rendered


KEYS: dict[str, Callable[[Session], Any]] = {
    **{name: act for feature in FEATURES.values() for name, act in feature.keys.items()},
    "undo": partial(travel, by=-1),
    "redo": partial(travel, by=1),
    "reset": reset,
    "rendered": toggle_rendered,
    "play": play,
    "next": partial(step, count=1),
    "previous": partial(step, count=-1),
    "frame": frame,
    "parent": to_parent,
    "child": to_child,
}
"""By their names in `frontend/page/keys.js`."""
