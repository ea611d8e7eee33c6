"""Session of one page: it holds the state, the view and the work; commands act on it."""

import logging
import shutil
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Protocol, TypeVar, Unpack

from cutcell.errors import CutcellError
from cutcell_viewers.camera import Camera
from cutcell_viewers.description import Description

from ..derive.engine import Engine
from ..derive.jobs import Schedule
from ..derive.tasks import Tasks
from ..derive.work import Work
from ..files.edits_file import EditsFile
from ..files.upload_cache import UPLOADS, PageUploads
from ..server.messages import error_text
from ..server.protocol.received import Message
from ..server.protocol.sent import ToBrowser
from .document import Document, History
from .state import State

logger = logging.getLogger("cutcell.app")

WAITING = "waiting for the weights"
"""The stage of an export before there is what it exports."""


@dataclass(frozen=True)
class BeforeLesson:
    """The page from before the lesson."""

    history: History
    document: Document
    camera: Camera | None
    tools: dict[str, Any]


M = TypeVar("M", bound=Message)


class View(Protocol):
    """Interface of the 3D view for commands; see `widgets.view.SceneView`."""

    camera: Camera | None
    at_home: bool
    on_camera: Callable[[], None]
    aspect: float
    page_height: float
    time: float
    calm: bool
    page_before: str

    def listen(self, kind: type[M], act: Callable[[M], Any]) -> None:
        """Call a function with every message of a kind that the browser sends."""

    def present(self, description: Description, **parts: Any) -> None:
        """Show a scene, together with parts of the view that belong to it."""

    def send(self, **parts: Unpack[ToBrowser]) -> None:
        """Send parts of the view that are no actors; they are kept for a browser that comes."""

    def last_sent(self, name: str) -> Any:
        """Return the last value sent for a part; None if none was."""

    def offer(self, name: str, content: bytes) -> None:
        """Send a file to the browser, which saves it."""

    def answer(self, **message: Unpack[ToBrowser]) -> None:
        """Answer a request of the browser."""


class Session:
    """The store of one page, its view, and its work.

    Parameters
    ----------
    view : View
    schedule : callable
        See `derive.jobs.Schedule`.
    state : State

    Attributes
    ----------
    work : Work
        All work off the page's thread.
    tasks : Tasks
        What a person has started: openings, repairs, templates.
    engine : Engine
        It keeps the results up to the state.
    history : History
    uploads : PageUploads
    source : str
        Key that opens the current character again; see `Document`.
    paths : list of Path
        Files of this machine that the page was opened with.
    before_lesson : BeforeLesson or None
    computed : Document or None
        What was computed last.
    older_message : tuple or None
        The message from before the last change: new weights remove it.
    edits_file : EditsFile
        Edits that are too long for the address.
    exports : list of callable
        Exports that wait for their turn or for the weights; see `export_queue`.
    """

    def __init__(self, view: View, schedule: Schedule, state: State) -> None:
        self.state = state
        self.view = view
        self.work = Work(schedule, self.fail, self.show_progress)
        self.tasks = Tasks(self.work, self.fail, self.show_progress)
        self.engine = Engine(self.state, self.work, self)
        self.history = History()
        self.uploads = PageUploads(UPLOADS)
        self.source = ""
        self.paths: list[Path] | None = None
        self.before_lesson: BeforeLesson | None = None
        self.computed: Document | None = None
        self.older_message: tuple[str, str] | None = None
        self.edits_file = EditsFile(self.uploads)
        self.exports: list[Callable[[], None]] = []
        self._folder: Path | None = None

    def show_progress(self) -> None:
        """Show the progress of the work that was started first, and of an export beside it."""
        progress = self.work.progress
        others = [one for name, one in progress.items() if name != "export"]
        export = progress.get("export", (WAITING, 0.0) if self.exports else None)
        current = progress.get(self.tasks.running) or (others[0] if others else export)
        stage, fraction = current or (self.state.stage, self.state.fraction)
        if self.tasks.titles:
            stage = f"{stage}, then {' and '.join(self.tasks.titles)}"
        self.state.param.update(
            busy=bool(current),
            stage=stage,
            fraction=fraction,
            exporting=export[0] if others and export else "",
        )

    def drop_exports(self) -> None:
        """Drop exports that wait, and add that to the message."""
        if self.exports:
            self.exports.clear()
            self.show_progress()
            severity, text = self.state.message or ("info", "")
            self.state.message = (severity, f"{text} Nothing was exported.".strip())

    def fail(self, error: Exception) -> None:
        """Show an error; the page is unchanged."""
        if not isinstance(error, CutcellError | MemoryError):
            logger.error("unexpected error", exc_info=error)
        self.state.message = ("error", error_text(error))

    def refuse(self, error: CutcellError, choice: str = "edits") -> None:
        """Reset the controls to what is chosen, then show why a new choice is refused.

        In this order: who reads the error may enter something else at once.
        """
        self.state.param.trigger(choice)
        self.fail(error)

    @property
    def folder(self) -> Path:
        """A folder for files that are about to be handed over."""
        if self._folder is None or not self._folder.is_dir():
            self._folder = UPLOADS.storage.make()
        return self._folder

    def close(self) -> None:
        """Stop all work and remove what was uploaded."""
        self.work.close()
        self.edits_file.close()
        self.uploads.close()
        if self._folder is not None:
            shutil.rmtree(self._folder, ignore_errors=True)
