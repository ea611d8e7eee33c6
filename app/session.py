"""What one browser's page does: opens characters, binds them, shows the result."""

from __future__ import annotations

import functools
import logging
import tempfile
import threading
from collections.abc import Callable
from pathlib import Path
from threading import Lock
from typing import Any

from param.parameterized import batch_call_watchers

import cutcell
from assets import DEMOS, demo_path
from cutcell.errors import CutcellError, FileError
from cutcell.progress import Progress
from cutcell.rig import Rig
from viewers.scene import Camera, framing

from .actions import WATCHERS, compare, learn, weights
from .choices import first_clip, from_query
from .jobs import COMPUTING, Jobs, Schedule
from .keep import KEEP
from .scenes import Memo, resolve
from .scenes.common import bones_part, bounds_of, first_joint, theme_of
from .state import UNSEEN, State
from .state.method import GRAPH, method_of
from .upload import Receiver
from .view import SceneView, camera_part, theme_part

logger = logging.getLogger("cutcell.app")

PAUSE = 0.2
"""Seconds without a change of the graph's parameters before it is built again."""

GONE = (
    "The character of this address was uploaded, and the server no longer has it; here is "
    "another. Drop the file again to go on with it."
)

COMPANIONS = {".txt", ".json", ".mtl", ".bin", ".png", ".jpg", ".jpeg"}
"""Files that come along with the one that is opened."""


class Session:
    """The state of one page, its view, and the work that goes on for it.

    Parameters
    ----------
    schedule : callable
        Runs a function on the page's own thread; see `Jobs`.
    """

    def __init__(self, schedule: Schedule) -> None:
        self.state = State()
        self.habits: Any = None
        self._schedule = schedule
        self._files = tempfile.TemporaryDirectory(prefix="cutcell-", ignore_cleanup_errors=True)
        self.folder = Path(self._files.name)
        self.view = SceneView(
            self.pick,
            self.receiver(),
            sizing_mode="stretch_both",
        )
        self._jobs: dict[str, Jobs] = {}
        self._closed = False
        self.falloffs: dict[str, tuple[Any, float, Any]] = {}
        self._bound_for: dict[str, Any] = {}
        self._timer: threading.Timer | None = None
        self.kept = ""
        self._held: set[str] = set()
        self._note = ""
        self._arrival: dict[str, Any] = {}
        self.memo = Memo()
        seen = [name for name in self.state.param if name not in UNSEEN]
        self.state.param.watch(self._refresh, seen)
        self.view.listen("pick-vertex", lambda message: self.pick_vertex(int(message["vertex"])))
        for watch in WATCHERS:
            watch(self)
        self.state.param.watch(self._theme, "dark")
        self.state.param.watch(lambda *events: self._soon(self._rebind), list(GRAPH))
        self._theme()

    def later(self, action: Callable[[], Any]) -> None:
        """Run an action on the page's own thread; what goes wrong in it is told."""

        def guarded() -> None:
            try:
                action()
            except Exception as error:
                self.fail(error)

        self._schedule(guarded)

    def _soon(self, action: Callable[[], Any]) -> None:
        """Run an action when a person has paused for a moment; a newer one takes its place."""
        if self._timer is not None:
            self._timer.cancel()
        self._timer = threading.Timer(PAUSE, lambda: self.later(action))
        self._timer.daemon = True
        self._timer.start()

    def jobs(self, name: str) -> Jobs:
        """Return the work of one name: a newer piece of it stops the one before."""
        if name not in self._jobs:
            self._jobs[name] = Jobs(self.later)
            if self._closed:
                self._jobs[name].close()
        return self._jobs[name]

    # Opening

    def open_demo(
        self,
        id: str,
        chosen: Callable[[], None] = lambda: None,
        then: Callable[[], None] = lambda: None,
    ) -> None:
        """Show a demo character and bind it.

        Parameters
        ----------
        id : str
        chosen : callable
            Chooses more, together with the character.
        then : callable
            Called when it stands there.
        """
        self.state.demo = id
        title = next(demo.title for demo in DEMOS if demo.id == id)
        self._open(lambda: demo_rig(id), f"opening {title}", lambda: self._keep(""), chosen, then)

    def open_files(self, paths: list[Path], key: str = "") -> None:
        """Show the character in some files, and bind it.

        Parameters
        ----------
        paths : list of Path
            The file, and those that belong to it.
        key : str
            That of kept files, if they are; see `keep`.
        """
        try:
            path = main_file(paths)
        except CutcellError as error:
            self.fail(error)
            self._keep(self.kept)
            return
        opened = functools.partial(self._keep, key)
        self._open(lambda: cutcell.load(path), f"opening {path.name}", opened, demo="")

    def open_upload(self, paths: list[Path]) -> None:
        """Show the character in files that a person dropped; keep them for a while."""
        key, here = KEEP.put(paths)
        self._held.add(key)
        self.open_files(here, key)

    def arrive(self, query: str, otherwise: Callable[[], None]) -> None:
        """Show what an address says.

        Parameters
        ----------
        query : str
        otherwise : callable
            Opens a character where the address names none that is there.
        """
        choices, arrival, problems = from_query(query, self.state)
        self.state.param.update(**choices)
        self._arrival = arrival
        rig = arrival.get("rig", "")
        kept = KEEP.take(rig[1:]) if rig.startswith("~") else None
        demo = any(demo.id == rig and demo.path.exists() for demo in DEMOS)
        if rig and not rig.startswith("~") and not demo:
            problems.append(f"rig={rig}"[:60])
        if rig.startswith("~") and kept is None:
            arrival["told"] = GONE
        elif problems:
            arrival["told"] = (
                f"The address says what this page does not know ({', '.join(problems)}); "
                "the rest of it was taken."
            )
        if learn.opens(arrival):
            learn.go(self, arrival["tour"], frozenset({**choices, **arrival}))
        elif kept is not None:
            self._held.add(rig[1:])
            self.open_files(kept, rig[1:])
        elif demo:
            self.open_demo(rig)
        else:
            otherwise()

    def _keep(self, key: str) -> None:
        self.kept = key
        for other in self._held - {key}:
            self._held.remove(other)
            KEEP.leave(other)

    def receiver(self) -> Receiver:
        """Return what takes files from the browser and opens them."""
        return Receiver(self.folder, self.open_upload, self.fail)

    def open_rig(self, rig: Rig) -> None:
        """Show a character that is loaded already, and bind it."""
        self.state.demo = ""
        self._stand(rig)

    def _open(
        self,
        load: Callable[[], Rig],
        stage: str,
        opened: Callable[[], None] = lambda: None,
        chosen: Callable[[], None] = lambda: None,
        then: Callable[[], None] = lambda: None,
        **more: Any,
    ) -> None:
        def work(progress: Progress) -> Rig:
            progress(stage, 0.0)
            return load()

        def done(rig: Rig) -> None:
            opened()
            self.state.param.update(**more)
            self._stand(rig, chosen)
            then()

        self.start(work, done)

    def _stand(self, rig: Rig, chosen: Callable[[], None] = lambda: None) -> None:
        state = self.state
        self.jobs("field").cancel()
        before, arrival, self._arrival = state.rig, self._arrival, {}
        # All at once: a menu whose value changes twice in a moment may tell the first one back.
        with batch_call_watchers(state):
            state.param.update(
                rig=rig, binding=None, field=None, turns={}, moving=False, playing=False,
                clip=first_clip(rig), message=None, joint=first_joint(rig), vertex=None,
            )  # fmt: skip
            self._land(rig, arrival)
            compare.carry(state, before, arrival)
            chosen()
        self.view.camera = framing(bounds_of(state), 1.2)
        self.view.at_home = True
        camera = camera_part(self.view.camera)
        self.view.tell(bones=bones_part(state), camera=camera)
        if "camera" in arrival:
            eye, target = arrival["camera"][:3], arrival["camera"][3:]
            self.look(Camera(tuple(eye), tuple(target)))
        self.habits.begin()
        self.bind()

    def _land(self, rig: Rig, arrival: dict[str, Any]) -> None:
        names, state = rig.skeleton.names, self.state
        if arrival.get("bone") in names:
            state.joint = names.index(arrival["bone"])
        state.turns = {j: t for j, t in arrival.get("turns", {}).items() if j < len(names)}
        if -1 <= arrival.get("clip", -2) < len(rig.clips):
            state.clip = arrival["clip"]
        state.tour = arrival.get("tour", state.tour)
        if 0 <= arrival.get("vertex", -1) < len(rig.mesh.vertices):
            state.vertex = arrival["vertex"]
        self._note = arrival.get("told", "")

    # Computing

    def bind(self) -> None:
        """Compute graph, distances and weights of the character that stands there."""
        state = self.state
        rig, method = state.rig, weights.generous(self)
        if rig is None:
            return
        self._bound_for = method_of(state, GRAPH)

        def done(binding: Any) -> None:
            binding = weights.bound(self, binding, method)
            note, self._note = self._note, ""
            message = ("info", note) if note else None
            state.param.update(binding=binding, field=None, message=message)
            if (state.falloff, state.alpha) != (method["falloff"], method["alpha"]):
                weights.weigh(self)  # another falloff was chosen in the meantime

        self.start(lambda progress: cutcell.bind(rig, progress=progress, **method), done)

    def _rebind(self) -> None:
        """Compute again if the graph's parameters are others than those last computed for."""
        if method_of(self.state, GRAPH) != self._bound_for:
            self.bind()

    def cancel(self) -> None:
        """Stop computing; what was there stays."""
        if self.jobs("main").cancel():
            self.state.param.update(
                busy=False, message=("info", "Cancelled. The page keeps what it had.")
            )

    def start(
        self,
        work: Callable[[Progress], Any],
        done: Callable[[Any], None],
        turn: Lock = COMPUTING,
    ) -> None:
        """Do some work that the page shows progress of; it stops what went on before."""

        def finish(result: Any) -> None:
            self.state.busy = self.jobs("main").running
            done(result)

        def failed(error: Exception) -> None:
            self.state.busy = False
            self.fail(error)

        self.state.param.update(busy=True, stage="", fraction=0.0)
        self.jobs("main").start(work, finish, failed, self._report, turn)

    def _report(self, stage: str, fraction: float) -> None:
        self.state.param.update(stage=stage, fraction=fraction)

    def fail(self, error: Exception) -> None:
        """Tell what went wrong; the page keeps what it had."""
        if isinstance(error, CutcellError):
            self.state.message = ("error", sentence(str(error)))
            return
        logger.error("unexpected error", exc_info=error)
        self.state.message = (
            "error",
            f"Something unexpected went wrong ({type(error).__name__}: {error}). The page keeps "
            "what it had; the details are in the server's log.",
        )

    # Looking

    def pick(self, joint: int) -> None:
        """Choose a joint; show its weights where the colours told of all joints."""
        state = self.state
        if state.rig is None or not 0 <= joint < len(state.rig.skeleton.joints):
            return
        state.param.update(joint=joint, weights_shown="bone")

    def pick_vertex(self, vertex: int | None) -> None:
        """Choose a vertex to look at closely; None for no more."""
        state = self.state
        if state.rig is None or (vertex is not None and vertex >= len(state.rig.mesh.vertices)):
            return
        state.vertex = vertex

    def look(self, camera: Camera | None, aside: bool = False) -> None:
        """Look from somewhere; None for the view that one begins with.

        With `aside`, what is looked at stands left of the middle, beside a card.
        """
        home = camera_part(framing(bounds_of(self.state), 1.2))
        if camera is not None:
            self.view.camera, self.view.at_home = camera, False
            home["now"] = {**camera_part(camera), "aside": aside}
        self.view.tell(camera=home)

    def _refresh(self, *events: Any) -> None:
        self.view.present(resolve(self.state, self.memo))

    def _theme(self, *events: Any) -> None:
        self.view.tell(theme=theme_part(theme_of(self.state)))

    def close(self) -> None:
        """Stop all work and remove what was uploaded."""
        self._closed = True
        if self._timer is not None:
            self._timer.cancel()
        for jobs in self._jobs.values():
            jobs.close()
        self._keep("")
        self._files.cleanup()


@functools.cache
def demo_rig(id: str) -> Rig:
    """Return a demo character; it is read once, and nothing can write to it."""
    return cutcell.load(demo_path(id))


def main_file(paths: list[Path]) -> Path:
    """Return the one file of a dropped group that is to be opened.

    Raises
    ------
    FileError
        There is none, or more than one.
    """
    found = [path for path in paths if path.suffix.lower() not in COMPANIONS]
    names = ", ".join(path.name for path in paths)
    if not found:
        raise FileError(
            f"no character among the dropped files ({names}); drop a GLB, glTF, OBJ, PLY, STL, "
            "OFF or NPZ file, and the files that belong to it together with it"
        )
    if len(found) > 1:
        raise FileError(f"more than one character was dropped ({names}); drop one at a time")
    return found[0]


def sentence(text: str) -> str:
    """Return a message as a sentence: with a full stop, and a capital if it begins a word."""
    text = text.strip()
    first = text.split(" ", 1)[0]
    if first.isalpha():
        text = text[:1].upper() + text[1:]
    return text + ("" if text.endswith((".", "!", "?")) else ".")
