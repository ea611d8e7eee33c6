"""What a person takes along: the bound character, pictures, films, numbers."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

import cutcell
from cutcell.io import binary_ending
from cutcell.io.numbers import save_numbers
from cutcell.progress import Progress
from cutcell.rig import Clip
from viewers.description import Description
from viewers.film import Order
from viewers.pose_scene import clip_in_scene, pose_at, swing
from viewers.worker import draw_apart

from ..jobs import DRAWING
from ..scenes import following, resolve
from ..scenes.pose import SWING_DEGREES, clip_of
from ..state import State
from ..upload import safe_name

if TYPE_CHECKING:
    from ..session import Session

Done = Callable[[str, bytes], None]
"""Takes the name and the content of a file."""

PICTURE_PIXELS = 2400 * 1800
FILM_PIXELS = 960 * 720


def take_picture(session: Session, done: Done) -> None:
    """Draw what is seen, large and with its legend, and hand over the PNG."""
    _draw(session, _order(session, PICTURE_PIXELS, snapshot(session)), "png", done)


def take_turntable(session: Session, ending: str, done: Done) -> None:
    """Film what is seen while the camera goes around it once; "mp4" or "gif"."""
    order = replace(_order(session, FILM_PIXELS, snapshot(session)), turntable=True)
    _draw(session, order, ending, done)


def take_motion(session: Session, ending: str, done: Done) -> None:
    """Film the motion that is chosen, as what is seen now goes through it."""
    state = session.state
    if state.weights is None:
        session.state.message = ("info", "There are no weights to move the skin by yet.")
        return
    motion = clip_in_scene(state.rig, chosen_clip(state))
    order = _order(session, FILM_PIXELS, following(state, session.memo))
    _draw(session, replace(order, motion=motion), ending, done)


def take_numbers(session: Session, what: str, ending: str, done: Done) -> None:
    """Hand over "weights", "distances" or "all" as numbers, in a "csv" or "npz"."""
    binding, rig = session.state.binding, session.state.rig
    if binding is None:
        session.state.message = ("info", "There are no numbers to save yet.")
        return
    path = session.folder / f"{_stem(session)}-{'numbers' if what == 'all' else what}.{ending}"

    def work(progress: Progress) -> tuple[str, bytes]:
        tables = {}
        if what != "distances":
            tables["weights"] = binding.weights
        if what != "weights":
            tables["distances"] = binding.distances.all_joints(progress).T
        progress("writing the numbers", 0.0)
        save_numbers(path, rig, **tables)
        return _taken(path)

    session.start(work, lambda result: done(*result))


def bound_file(session: Session, done: Done) -> None:
    """Write the character with its new weights, and hand over its name and content."""
    state = session.state
    if state.binding is None:
        state.message = ("info", "There are no weights to download yet.")
        return
    rig = state.rig.with_weights(state.binding.weights)
    path = session.folder / f"{_stem(session)}-bound{binary_ending(rig)}"

    def work(progress: Progress) -> tuple[str, bytes]:
        progress("writing the file", 0.0)
        cutcell.save(path, rig)
        return _taken(path)

    session.start(work, lambda result: done(*result))


def chosen_clip(state: State) -> Clip:
    """Return the motion that is chosen, whether or not it is on."""
    if 0 <= state.clip < len(state.rig.clips):
        return state.rig.clips[state.clip]
    return swing(state.rig, state.joint, state.axis, SWING_DEGREES)


def snapshot(session: Session) -> Description:
    """Return what is seen, in the pose that a motion has come to."""
    description = resolve(session.state, session.memo)
    clip = clip_of(session.state)
    if clip is None or not len(clip.times):
        return description
    return replace(description, pose=pose_at(session.state.rig, clip, session.view.time))


def picture_size(pixels: int, aspect: float) -> tuple[int, int]:
    """Return width and height, even numbers, of about so many pixels in a given shape."""
    height = (pixels / aspect) ** 0.5
    return 2 * round(height * aspect / 2), 2 * round(height / 2)


def _order(session: Session, pixels: int, description: Description) -> Order:
    view = session.view
    theme = "dark" if session.state.dark else "light"
    return Order(description, theme, picture_size(pixels, view.aspect), view.camera)


def _draw(session: Session, order: Order, ending: str, done: Done) -> None:
    path = session.folder / f"{_stem(session)}-{session.state.panel}.{ending}"
    stage = "drawing the picture" if ending == "png" else "drawing the film"

    def work(progress: Progress) -> tuple[str, bytes]:
        draw_apart(order, path, lambda _, fraction: progress(stage, fraction))
        return _taken(path)

    session.start(work, lambda result: done(*result), turns=DRAWING)


def _stem(session: Session) -> str:
    """Return what the files of a character are called; its own name may be no file's name."""
    rig = session.state.rig
    return safe_name(Path(rig.name).stem) if rig is not None and rig.name else "character"


def _taken(path: Path) -> tuple[str, bytes]:
    content = path.read_bytes()
    path.unlink()
    return path.name, content
