"""Session of one page: its state, its view and its running tasks.

It does nothing by itself: commands, the functions of the modules beside this one, are given it, and
change the state; `watchers.follow` lets others follow.
"""

import logging
import shutil
from collections.abc import Callable
from pathlib import Path
from typing import Any, Protocol

from cutcell.errors import CutcellError
from cutcell.runtime.progress import Progress
from cutcell_viewers.camera import Camera
from cutcell_viewers.description import Description

from ..files.corrections_file import CorrectionsFile
from ..files.upload_cache import UPLOADS, PageUploads
from ..jobs.jobs import COMPUTING, Schedule, Slots
from ..jobs.messages import error_text
from ..jobs.tasks import Tasks
from ..scenes import Memo
from ..state import State
from ..state.bound import Binder
from ..state.history import History

logger = logging.getLogger("cutcell.app")


class View(Protocol):
    """Interface of the 3D view for commands; see `widgets.view.SceneView`."""

    camera: Camera | None
    at_home: bool
    on_camera: Callable[[], None]
    aspect: float
    page_height: float
    time: float
    calm: bool

    def listen(self, kind: str, act: Callable[[dict[str, Any]], Any]) -> None:
        """Call a function with every message of a kind that the browser sends."""

    def present(self, description: Description) -> None:
        """Show a scene."""

    def send(self, **parts: Any) -> None:
        """Send parts of the view that are no actors; they are kept for a browser that comes."""

    def last_sent(self, name: str) -> Any:
        """Return the last value sent for a part; None if none was."""

    def offer(self, name: str, content: bytes) -> None:
        """Send a file to the browser, which saves it."""

    def answer(self, **message: Any) -> None:
        """Answer a request of the browser."""


class Session:
    """The store of one page, its view, and its work.

    Parameters
    ----------
    view : View
    schedule : callable
        Runs a function on the page's own thread; see `Jobs`.

    Attributes
    ----------
    state : State
    tasks : Tasks
    memo : Memo
    history : History
    restoring : bool
        Whether choices of the past are being restored: they are not recorded again.
    uploads : PageUploads
    character : str
        Key that opens the current character again: "demo" and its id, or "~" and the key of
        uploaded files ("" for those of this machine); empty where nothing does.
    given : list of Path
        Files of this machine that the page was opened with.
    returning : bool
        Whether that character is shown because somebody went back to it.
    before_tour : tuple or None
        The choices and the camera from before the tour.
    arrival : dict
        Choices of the address for the character that is being loaded.
    binder : Binder
    kept : CorrectionsFile
        Corrections that are too long for the address.
    exports : list of callable
        Exports that wait for their turn or for the weights; see `export_queue`.
    """

    def __init__(self, view: View, schedule: Schedule) -> None:
        self.state = State()
        self.view = view
        self.tasks = Tasks(schedule, self.fail)
        self.memo = Memo()
        self.history = History({})
        self.restoring = False
        self.uploads = PageUploads(UPLOADS)
        self.character = ""
        self.given: list[Path] | None = None
        self.returning = False
        self.before_tour: tuple[dict[str, Any], Camera | None] | None = None
        self.arrival: dict[str, Any] = {}
        self.binder = Binder()
        self.kept = CorrectionsFile(self.uploads)
        self.exports: list[Callable[[], None]] = []
        self._progress: dict[str, tuple[str, float]] = {}
        self._folder: Path | None = None

    def start(
        self,
        work: Callable[[Progress], Any],
        done: Callable[[Any], None],
        slots: Slots = COMPUTING,
        failed: Callable[[], None] = lambda: None,
        name: str = "main",
    ) -> None:
        """Do some work that the page shows progress of; it stops earlier work of the same name.

        An error is reported, and then `failed` is called.
        """
        jobs = self.tasks.jobs(name)

        def finish(result: Any) -> None:
            if not jobs.running:
                self.ended(name)
            done(result)

        def went_wrong(error: Exception) -> None:
            self.ended(name)
            self.fail(error)
            failed()

        def report(stage: str, fraction: float) -> None:
            self.report(name, stage, fraction)

        report("", 0.0)
        jobs.start(work, finish, went_wrong, report, slots)

    def report(self, name: str, stage: str, fraction: float) -> None:
        """Show progress of work."""
        self._progress[name] = (stage, fraction)
        self._show_progress()

    def ended(self, name: str) -> None:
        """Show that work has ended."""
        self._progress.pop(name, None)
        self._show_progress()

    def _show_progress(self) -> None:
        shown = self._progress.get("main") or self._progress.get("export")
        stage, fraction = shown or (self.state.stage, self.state.fraction)
        self.state.param.update(
            busy=bool(shown),
            stage=stage,
            fraction=fraction,
            exporting=self._progress.get("export", ("",))[0] if "main" in self._progress else "",
        )

    def drop_exports(self) -> None:
        """Drop exports that wait, and add that to the message."""
        if self.exports:
            self.exports.clear()
            if not self.tasks.jobs("export").running:
                self.ended("export")
            severity, text = self.state.message or ("info", "")
            self.state.message = (severity, f"{text} Nothing was exported.".strip())

    def fail(self, error: Exception) -> None:
        """Show an error; the page is unchanged."""
        if not isinstance(error, CutcellError | MemoryError):
            logger.error("unexpected error", exc_info=error)
        self.state.message = ("error", error_text(error))

    @property
    def folder(self) -> Path:
        """A folder for files that are about to be handed over."""
        if self._folder is None or not self._folder.is_dir():
            self._folder = UPLOADS.storage.make()
        return self._folder

    def close(self) -> None:
        """Stop all work and remove what was uploaded."""
        self.tasks.close()
        self.kept.close()
        self.uploads.close()
        if self._folder is not None:
            shutil.rmtree(self._folder, ignore_errors=True)
