"""Export the bound character, pictures, films, numbers."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial, wraps
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from cutcell.editing.stored import save_bound, settings_with_layers
from cutcell.io import binary_ending
from cutcell.pose import pose_at
from cutcell.runtime.progress import Progress
from cutcell_viewers.camera import Camera
from cutcell_viewers.character import pose_in_scene
from cutcell_viewers.description import Description
from cutcell_viewers.order import FRAMES, Order
from cutcell_viewers.pose_scene import clip_in_scene
from cutcell_viewers.process import draw_isolated

from ...derive.jobs import COMPUTING, DRAWING, Slots
from ...derive.processes import in_process
from ...document.session import Session
from ...document.state import State
from ...features.scenes import following, resolve
from ...files.receive import safe_name
from ...files.table_export import save_graph, save_numbers, settings_of
from ...looks.pose import chosen_clip, clip_of
from .export_queue import proceed, when_ready
from .sweep import sweep_of, sweep_scenes

Done = Callable[[str, bytes], None]
"""Takes the name and the content of a file."""

PICTURE_PIXELS = 2400 * 1800
FILM_PIXELS = 960 * 720

ENDED = "writing it came to a sudden end; there may be too little memory"


@dataclass(frozen=True)
class Seen:
    """Snapshot of the page, for a thread that draws it later."""

    state: State
    camera: Camera | None
    aspect: float
    height: float
    time: float

    @classmethod
    def now(cls, session: Session) -> Seen:
        """Take a snapshot of a session's page."""
        view = session.view
        seen = view.camera, view.aspect, view.page_height, view.time
        return cls(session.state.snapshot(), *seen)

    def posed(self) -> Description:
        """Return the scene, in the pose that a motion has come to."""
        description, clip = resolve(self.state), clip_of(self.state)
        if clip is None or not len(clip.times):
            return description
        return replace(description, pose=pose_in_scene(self.state.rig, pose_at(clip, self.time)))

    def order(self, pixels: int, description: Description) -> Order:
        """Return the order of a picture of a scene, from the current camera."""
        theme = "dark" if self.state.dark else "light"
        size = picture_size(pixels, self.aspect)
        return Order(description, theme, size, self.camera, page_height=self.height)


def queued(export: Callable[..., None]) -> Callable[..., None]:
    """Delay an export until the page has the weights of the settings that it shows."""

    @wraps(export)
    def export_later(session: Session, *arguments: Any, **options: Any) -> None:
        when_ready(session, lambda: export(session, *arguments, **options))

    return export_later


@queued
def export_picture(session: Session, done: Done) -> None:
    """Draw the view, large and with its legend, and hand over the PNG."""
    _draw(session, "png", done, lambda seen, _: seen.order(PICTURE_PIXELS, seen.posed()))


@queued
def export_turntable(session: Session, ending: str, done: Done) -> None:
    """Film the view while the camera circles it once; "mp4" or "gif"."""

    def order(seen: Seen, progress: Progress) -> Order:
        return replace(seen.order(FILM_PIXELS, seen.posed()), turntable=True)

    _draw(session, ending, done, order)


@queued
def export_motion(session: Session, ending: str, done: Done) -> None:
    """Film the motion that is chosen, as what is seen now goes through it."""
    if session.state.weights is None:
        session.state.message = ("info", "There are no weights to move the skin by yet.")
        return

    def order(seen: Seen, progress: Progress) -> Order:
        motion = clip_in_scene(seen.state.rig, chosen_clip(seen.state))
        return replace(seen.order(FILM_PIXELS, following(seen.state)), motion=motion)

    _draw(session, ending, done, order)


@queued
def export_sweep(session: Session, ending: str, done: Done) -> None:
    """Film the wavefront where it is shown, else the cut, as it runs from 0 to 1."""
    name, rate = sweep_of(session.state), FRAMES[f".{ending}"]
    if name is None:
        session.state.message = ("info", "Turn on the wavefront or a cut first.")
        return

    def order(seen: Seen, progress: Progress) -> Order:
        scenes = sweep_scenes(seen.state, name, rate, progress)
        return replace(seen.order(FILM_PIXELS, scenes[-1]), scenes=scenes)

    _draw(session, ending, done, order)


@queued
def export_interactive(session: Session, page: Callable[..., str], done: Done) -> None:
    """Write the character as an interactive page that needs no server, and hand over the HTML.

    `page` is given the rig, its binding, the chosen joint and how to report progress.
    """
    state = session.state
    if state.binding is None:
        state.message = ("info", "There are no weights to show yet.")
        return
    rig, binding, joint = state.rig, state.binding, state.joint

    def write(path: Path, progress: Progress) -> None:
        content = page(rig, binding, joint=joint, progress=progress)
        path.write_text(content, encoding="utf-8")

    _hand_over(session, f"{stem_of(session)}.html", write, done)


@queued
def export_numbers(session: Session, what: str, ending: str, done: Done) -> None:
    """Hand over "weights", "distances" or "all" as numbers, in a "csv" or "npz"."""
    binding, rig = session.state.binding, session.state.rig
    if binding is None:
        session.state.message = ("info", "There are no numbers to save yet.")
        return
    named = replace(rig, clips=(), attachments=(), source=None)
    name = f"{stem_of(session)}-{'numbers' if what == 'all' else what}.{ending}"

    def write(path: Path, progress: Progress) -> None:
        tables = {}
        if what != "distances":
            tables["weights"] = binding.weights
        if what != "weights":
            unit = binding.graph.lattice.size
            tables["distances"] = binding.distances.of_all_joints(progress).joint.T * unit
        check = partial(progress, "writing the numbers", 0.0)
        save = partial(save_numbers, path, named, settings=settings_of(binding), **tables)
        in_process(save, check=check, ended=ENDED)

    _hand_over(session, name, write, done)


@queued
def export_graph(session: Session, ending: str, done: Done) -> None:
    """Hand over the graph's nodes and edges as numbers, in a "zip" of tables or an "npz"."""
    graph = session.state.graph
    if graph is None:
        session.state.message = ("info", "There is no graph to save yet.")
        return

    def write(path: Path, progress: Progress) -> None:
        progress("writing the numbers", 0.0)
        save_graph(path, graph)

    _hand_over(session, f"{stem_of(session)}-graph.{ending}", write, done)


@queued
def export_bound(session: Session, done: Done) -> None:
    """Write the character with its new weights, and hand over its name and content."""
    state = session.state
    if state.binding is None:
        state.message = ("info", "There are no weights to download yet.")
        return
    rig = state.rig.with_weights(state.binding.weights)
    binding = state.binding
    settings = settings_with_layers(state.rig, binding.method, binding.weights, state.edits)

    def write(path: Path, progress: Progress) -> None:
        check = partial(progress, "writing the file", 0.0)
        in_process(save_bound, path, rig, settings, check=check, ended=ENDED)

    _hand_over(session, f"{stem_of(session)}-bound{binary_ending(rig)}", write, done)


def picture_size(pixels: int, aspect: float) -> tuple[int, int]:
    """Return width and height, even numbers, for a number of pixels and an aspect."""
    height = (pixels / aspect) ** 0.5
    return 2 * round(height * aspect / 2), 2 * round(height / 2)


def _draw(
    session: Session, ending: str, done: Done, order: Callable[[Seen, Progress], Order]
) -> None:
    """Draw the current view; describing a large character is slow, too."""
    snapshot = Seen.now(session)
    stage = "drawing the picture" if ending == "png" else "drawing the film"

    def write(path: Path, progress: Progress) -> None:
        progress(stage, 0.0)

        def report(_: str, fraction: float) -> None:
            progress(stage, fraction)

        draw_isolated(order(snapshot, report), path, report)

    _hand_over(session, f"{stem_of(session)}-{snapshot.state.panel}.{ending}", write, done, DRAWING)


def _hand_over(
    session: Session,
    name: str,
    write: Callable[[Path, Progress], None],
    done: Done,
    slots: Slots = COMPUTING,
) -> None:
    """Write a file, and return its name and content; nothing of it stays on the disk."""
    place = session.folder

    def work(progress: Progress) -> bytes:
        # A separate one: a stopped task may still write to its file.
        with TemporaryDirectory(dir=place, ignore_cleanup_errors=True) as folder:
            path = Path(folder, name)
            write(path, progress)
            return path.read_bytes()

    def next_export() -> None:
        session.work.later(lambda: proceed(session))

    def finish(content: bytes) -> None:
        next_export()
        done(name, content)

    session.work.start("export", work, finish, next_export, slots)


def stem_of(session: Session) -> str:
    """Return the stem of a character's exported files, safe as a file name."""
    rig = session.state.rig
    return safe_name(Path(rig.name).stem) if rig is not None and rig.name else "character"
