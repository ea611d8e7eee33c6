"""What one browser's page does: opens characters, binds them, shows the result."""

from __future__ import annotations

import logging
import shutil
import threading
from collections.abc import Callable
from pathlib import Path
from typing import Any

import cutcell
from cutcell.errors import CutcellError
from cutcell.progress import Progress
from viewers.camera import Camera, framing

from .actions import WATCHERS, weights
from .jobs import COMPUTING, Jobs, Newest, Schedule, Turns
from .keep import KEEP
from .messages import told
from .opening import Opening
from .scenes import Memo, resolve
from .scenes.common import bounds_of, theme_of
from .state import UNSEEN, State
from .state.method import GRAPH, WEIGHTS, method_of
from .view import SceneView, camera_part, theme_part

logger = logging.getLogger("cutcell.app")

PAUSE = 0.2
"""Seconds without a change of the graph's parameters before it is built again."""


class Session:
    """The state of one page, its view, and the work that goes on for it.

    Parameters
    ----------
    schedule : callable
        Runs a function on the page's own thread; see `Jobs`.
    """

    def __init__(self, schedule: Schedule) -> None:
        self.state = State()
        self.opening = Opening(self)
        self.habits: Any = None
        self._schedule = schedule
        self._folder: Path | None = None
        self.view = SceneView(self.pick, self.opening.receiver(), sizing_mode="stretch_both")
        self._jobs: dict[str, Jobs] = {}
        self._newest: dict[str, Newest] = {}
        self._closed = False
        self.diagnosed: Any = None
        self.falloffs: dict[str, tuple[Any, Any]] = {}
        self._bound_for: dict[str, Any] = {}
        self._held: dict[str, Any] = {}
        self._timer: threading.Timer | None = None
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

    def newest(self, name: str) -> Newest:
        """Return the work of one name of which only the newest matters."""
        if name not in self._newest:
            self._newest[name] = Newest(self.jobs(name), self.fail)
        return self._newest[name]

    @property
    def working(self) -> bool:
        """Whether there is work that was neither finished nor stopped, or is about to begin."""
        waiting = self._timer is not None and self._timer.is_alive()
        return waiting or any(jobs.running for jobs in self._jobs.values())

    # Computing

    def bind(self, told: tuple[str, str] | None = None) -> None:
        """Compute graph, distances and weights of the character that stands there.

        Parameters
        ----------
        told : (severity, sentence), optional
            What is still to be read when it is done.
        """
        state = self.state
        rig, method = state.rig, weights.generous(self)
        if rig is None:
            return
        if state.bare:
            self._build(told)
            return
        graph = self._bound_for = method_of(state, GRAPH)

        few = weights.kept(state)

        def work(progress: Progress) -> Any:
            generous = cutcell.bind(rig, progress=progress, **method)
            return generous, weights.pruned(generous, few)

        def done(bindings: Any) -> None:
            self._held = graph
            generous, binding = bindings
            self.falloffs = {method["falloff"]: (generous.distances, generous.weights)}
            note = self.opening.take_note()
            message = ("info", note) if note and told is None else told
            state.param.update(binding=binding, field=None, message=message)
            if method_of(state, WEIGHTS) != {**{name: method[name] for name in WEIGHTS}, **few}:
                weights.weigh(self)  # others were chosen in the meantime

        self.start(work, done, failed=lambda: self._go_back(graph))

    def _build(self, told: tuple[str, str] | None) -> None:
        """Build the graph of a mesh without a skeleton."""
        rig = self.state.rig
        wanted = self._bound_for = method_of(self.state, GRAPH)
        chosen = {name: value for name, value in wanted.items() if name != "leaf"}

        def done(graph: Any) -> None:
            self._held = wanted
            self.state.param.update(bare_graph=graph, message=told)

        self.start(
            lambda progress: cutcell.build_graph(rig.mesh, progress=progress, **chosen),
            done,
            failed=lambda: self._go_back(wanted),
        )

    def _go_back(self, graph: dict[str, Any]) -> None:
        """Choose what the page holds instead of what no graph came of; at first, the defaults."""
        state = self.state
        held = self._held if state.graph is not None else method_of(State(), GRAPH)
        if method_of(state, GRAPH) != graph or graph == held:
            return
        self._bound_for = held
        self.habits.withdraw(held)
        if state.graph is None:
            self.bind(state.message)

    def _rebind(self) -> None:
        """Compute again if the graph's parameters are others than those last computed for."""
        if method_of(self.state, GRAPH) != self._bound_for:
            self.bind()

    def cancel(self) -> None:
        """Stop computing; what was there stays."""
        if self.jobs("main").cancel():
            self.opening.stay()
            self.state.param.update(
                busy=False, message=("info", "Cancelled. The page keeps what it had.")
            )
            if self.state.graph is not None:
                self._go_back(self._bound_for)

    def start(
        self,
        work: Callable[[Progress], Any],
        done: Callable[[Any], None],
        turns: Turns = COMPUTING,
        failed: Callable[[], None] = lambda: None,
    ) -> None:
        """Do some work that the page shows progress of; it stops what went on before.

        What goes wrong is told, and then `failed` is called.
        """

        def finish(result: Any) -> None:
            self.state.busy = self.jobs("main").running
            done(result)

        def went_wrong(error: Exception) -> None:
            self.state.busy = False
            self.fail(error)
            failed()

        self.state.param.update(busy=True, stage="", fraction=0.0)
        self.jobs("main").start(work, finish, went_wrong, self._report, turns)

    def _report(self, stage: str, fraction: float) -> None:
        self.state.param.update(stage=stage, fraction=fraction)

    def fail(self, error: Exception) -> None:
        """Tell what went wrong; the page keeps what it had."""
        if not isinstance(error, CutcellError | MemoryError):
            logger.error("unexpected error", exc_info=error)
        self.state.message = ("error", told(error))

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
        count = 0 if state.rig is None or state.bare else len(state.rig.mesh.vertices)
        if vertex is not None and vertex >= count:
            return
        state.vertex = vertex

    def look(self, camera: Camera | None) -> None:
        """Look from somewhere; None for the view that one begins with."""
        home = camera_part(framing(bounds_of(self.state), 1.2))
        if camera is not None:
            self.view.camera, self.view.at_home = camera, False
            home["now"] = camera_part(camera)
        self.view.tell(camera=home)

    def _refresh(self, *events: Any) -> None:
        scene = self.newest("scene")
        if self.state.quick:
            scene.cancel()
            self.view.present(resolve(self.state, self.memo))
        else:
            now = self.state.still()
            scene.do(lambda progress: resolve(now, self.memo), self.view.present)

    def _theme(self, *events: Any) -> None:
        self.view.tell(theme=theme_part(theme_of(self.state)))

    @property
    def folder(self) -> Path:
        """A folder for files that are about to be handed over."""
        if self._folder is None or not self._folder.is_dir():
            self._folder = KEEP.storage.make()
        return self._folder

    def close(self) -> None:
        """Stop all work and remove what was uploaded."""
        self._closed = True
        if self._timer is not None:
            self._timer.cancel()
        for jobs in self._jobs.values():
            jobs.close()
        self.opening.close()
        if self._folder is not None:
            shutil.rmtree(self._folder, ignore_errors=True)
