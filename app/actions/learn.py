"""Go to a step of the tour: set the scene so that its point is seen."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
import param

from viewers.character import to_scene
from viewers.scene import Camera, framing

from ..choices import defaults
from ..scenes.common import bounds_of
from ..tour import TOUR, Step

if TYPE_CHECKING:
    from ..session import Session


def go(session: Session, index: int) -> None:
    """Show a step of the tour; -1 leaves it, and the page stays as it is."""
    state = session.state
    if not 0 <= index < len(TOUR):
        state.tour = -1
        return
    step = TOUR[index]
    state.tour = index
    if state.demo == step.demo and state.rig is not None:
        show(session, step)
    else:
        session.open_demo(step.demo, lambda: show(session, step))


def show(session: Session, step: Step) -> None:
    """Make the page what a step asks for; its character stands there."""
    state = session.state
    names = state.rig.skeleton.names
    wanted = {**defaults(state), "moving": False, "playing": False, **step.choices}
    panel = next(panel for panel in step.panels if panel in shown_panels())
    known = {name: value for name, value in wanted.items() if _fits(state, name, value)}
    if step.bone in names:
        known["joint"] = names.index(step.bone)
    state.param.update(panel=panel, **known)
    session.look(camera_of(session, step), aside=True)


def shown_panels() -> frozenset[str]:
    """Return the ids of the panels that the page has."""
    from ..panels import PANELS

    return frozenset(panel.id for panel in PANELS)


def camera_of(session: Session, step: Step) -> Camera | None:
    """Return where a step looks from; None for the view that one begins with."""
    state = session.state
    around, above = np.radians(step.angles)
    bounds = bounds_of(state)
    whole = framing(bounds, 1.0)
    target = np.array(whole.focal_point)
    distance = float(np.linalg.norm(np.array(whole.position) - target)) * step.near
    names = state.rig.skeleton.names
    if step.focus in names:
        joint = state.rig.skeleton.joints[names.index(step.focus)]
        target = to_scene(state.rig, joint[None])[0]
    way = np.array([np.cos(above) * np.sin(around), np.sin(above), np.cos(above) * np.cos(around)])
    eye = target + distance * way
    return Camera(tuple(eye.tolist()), tuple(target.tolist()))


def _fits(state: Any, name: str, value: Any) -> bool:
    if name not in state.param:
        return False
    parameter = state.param[name]
    return not isinstance(parameter, param.Selector) or value in parameter.objects
