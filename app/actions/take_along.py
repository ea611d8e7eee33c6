"""What a person takes along: the bound character, a picture."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

import cutcell
from cutcell.progress import Progress
from viewers.description import Description
from viewers.opengl import require_opengl
from viewers.pose_scene import pose_at
from viewers.scene import Scene, framing

from ..scenes import resolve
from ..scenes.common import bounds_of, theme_of
from ..scenes.pose import clip_of

if TYPE_CHECKING:
    from ..session import Session


def take_picture(session: Session, done: Callable[[str, bytes], None]) -> None:
    """Draw what is seen, if this machine can, and hand over a name and the PNG."""

    def work(progress: Progress) -> None:
        progress("drawing the picture", 0.0)
        require_opengl()

    session.start(work, lambda _: done("cutcell.png", picture(session)))


def picture(session: Session, size: tuple[int, int] = (1600, 1200)) -> bytes:
    """Return what is seen as a PNG, drawn off-screen with the view's camera."""
    path = session.folder / "picture.png"
    scene = Scene(theme_of(session.state), size)
    try:
        scene.show(_snapshot(session))
        fitting = framing(bounds_of(session.state), size[0] / size[1])
        scene.look(session.view.camera or fitting)
        scene.render_png(path)
    finally:
        scene.close()
    return path.read_bytes()


def _snapshot(session: Session) -> Description:
    description = resolve(session.state, session.memo)
    clip = clip_of(session.state)
    if clip is None or not len(clip.times):
        return description
    return replace(description, pose=pose_at(session.state.rig, clip, session.view.time))


def bound_file(session: Session, done: Callable[[str, bytes], None]) -> None:
    """Write the character with its new weights, and hand over its name and content."""
    state = session.state
    if state.binding is None:
        state.message = ("info", "There are no weights to download yet.")
        return
    rig = state.rig.with_weights(state.binding.weights)
    path = session.folder / f"{Path(rig.name).stem or 'character'}-bound.glb"

    def work(progress: Progress) -> tuple[str, bytes]:
        progress("writing the file", 0.0)
        cutcell.save(path, rig)
        return path.name, path.read_bytes()

    session.start(work, lambda result: done(*result))
