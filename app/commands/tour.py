"""Go to a step of the tour: set the scene so that its point is seen."""

from typing import Any

import numpy as np

from cutcell.rig import Rig
from cutcell_viewers.camera import Camera, framing
from cutcell_viewers.character import to_scene

from ..scenes.common import bounds_of
from ..state.corrections import applied, changed_only, changes
from ..state.tour import TOUR, Look
from ..state.url import defaults
from .loading import load_demo, revisit
from .look import set_camera
from .session import Session


def go(session: Session, index: int, url_values: frozenset[str] = frozenset()) -> None:
    """Show a step of the tour; -1 leaves it, and brings back what the page showed before.

    Parameters
    ----------
    session : Session
    index : int
    said : set of str
        What an address that names the step says beside it, and what therefore stays.
    """
    state = session.state
    if not 0 <= index < len(TOUR):
        leave(session)
        return
    if state.tour < 0 and state.rig is not None:
        camera = None if session.view.at_home else session.view.camera
        session.before_tour = session.history.now, camera
    aspect = TOUR[index].look
    stands = _stands(state, aspect.demo)
    state.param.update(tour=index, demo=aspect.demo)  # together: one entry of the browser's history
    if stands:
        show(session, aspect, url_values)
        aim(session, aspect)
    else:
        load_demo(
            session,
            aspect.demo,
            lambda: show(session, aspect, url_values),
            lambda: None if "camera" in url_values else aim(session, aspect),
        )


def leave(session: Session) -> None:
    """End the tour, and restore the character, the choices and the camera.

    A character that a person opened on the tour stays, with its choices.
    """
    state = session.state
    before, session.before_tour = session.before_tour, None
    demo = TOUR[state.tour].look.demo if state.tour >= 0 else ""
    state.tour = -1
    if before is not None and session.character in (before[0]["character"], f"demo {demo}"):
        choices, camera = before
        revisit(session, choices)
        if choices["character"] == session.character:
            set_camera(session, camera)


def offer(session: Session, index: int) -> None:
    """Apply the choices of a button on the step's card."""
    state = session.state
    if 0 <= state.tour < len(TOUR) and 0 <= index < len(TOUR[state.tour].offers):
        state.param.update(**TOUR[state.tour].offers[index].choices)


def pressed_offers(state: Any) -> list[bool]:
    """Return for each button on the step's card whether what it chooses is chosen."""
    if not 0 <= state.tour < len(TOUR):
        return []
    return [
        all(getattr(state, name) == value for name, value in one.choices.items())
        for one in TOUR[state.tour].offers
    ]


def opens(arrival: dict[str, Any]) -> bool:
    """Whether an address leaves the scene to the step that it names.

    One that the page made tells the bone, and all that a person changed since.
    """
    if "tour" not in arrival or "bone" in arrival:
        return False
    return bool(arrival.get("rig", demo_of(arrival)) == demo_of(arrival))


def demo_of(arrival: dict[str, Any]) -> str:
    """Return the character of the step that an address names."""
    return str(TOUR[arrival["tour"]].look.demo)


def show(session: Session, scene_: Look, url_values: frozenset[str] = frozenset()) -> None:
    """Choose what a step asks for, but for what an address said; its character is there."""
    state = session.state
    names = list(state.rig.skeleton.names)
    scene = {
        **defaults(state),
        "panel": scene_.panel,
        "joint": names.index(scene_.bone),
        "turns": {names.index(name): angles for name, angles in scene_.turns.items()},
        "vertex": clicked(state.rig, scene_),
        "moving": False,
        "playing": False,
        "animating": False,
        **scene_.choices,
    }
    given_choices = url_values - {"panel"} if state.panel == "learn" else url_values
    if "corrections" not in given_choices:
        rig = applied(state.own, scene["corrections"])
        scene = {**changes(state, rig, scene["corrections"]), **scene, "rig": rig}
    chosen = {name: value for name, value in scene.items() if name not in given_choices}
    state.param.update(**changed_only(state, chosen))


def aim(session: Session, scene_: Look) -> None:
    """Look from where a step does."""
    set_camera(session, camera_of(session, scene_))


def points_out(state: Any) -> bool:
    """Whether the chosen vertex is one that the tour clicked, not a person."""
    if state.tour < 0 or state.rig is None or state.vertex is None:
        return False
    aspect = TOUR[state.tour].look
    return state.demo == aspect.demo and state.vertex == clicked(state.rig, aspect)


def clicked(rig: Rig, scene_: Look) -> int | None:
    """Return the vertex that a step clicks, or None."""
    if not scene_.clicked or rig.weights is None:
        return None
    names = rig.skeleton.names
    away = np.linalg.norm(rig.mesh.vertices - rig.skeleton.joints[names.index(scene_.bone)], axis=1)
    away[rig.weights.argmax(axis=1) != names.index(scene_.clicked)] = np.inf
    return int(away.argmin())


def camera_of(session: Session, scene_: Look) -> Camera:
    """Return where a step looks from."""
    rig = session.state.rig
    around, above = np.radians(scene_.angles)
    whole = framing(bounds_of(session.state), 1.0)
    target = np.array(whole.focal_point)
    distance = float(np.linalg.norm(np.array(whole.position) - target)) * scene_.near
    if scene_.focus:
        joint = rig.skeleton.joints[rig.skeleton.names.index(scene_.focus)]
        target = to_scene(rig, joint[None])[0]
    direction = np.array(
        [np.cos(above) * np.sin(around), np.sin(above), np.cos(above) * np.cos(around)]
    )
    eye = target + distance * direction
    return Camera(tuple(eye.tolist()), tuple(target.tolist()))


def _stands(state: Any, demo: str) -> bool:
    """Whether a demo character is loaded, and not just requested."""
    is_loaded = state.rig is not None and state.rig.name == demo
    return bool(state.demo == demo and is_loaded)
