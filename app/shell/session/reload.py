"""Reload of a page: the next page continues its history, selection and tools.

Each page has a key that cannot be guessed, and its browser's tab stores it. A page that is loaded
again sends the key of the page before, and begins with a copy of what that page has, or had when
it ended a short time ago: two tabs never share a history.
"""

import hashlib
import pickle
import secrets
import threading
import time
from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any
from weakref import WeakValueDictionary

import numpy as np
import param
from numpy.typing import NDArray

from cutcell.graph.fingerprint import data_fingerprint
from cutcell.rig import Rig

from ...document import loading
from ...document.document import Document, History
from ...document.opening import Request
from ...document.selection import Selection, selected
from ...document.session import BeforeLesson, Session
from ...document.state import State
from ...files.upload_cache import MB, STORED_SECONDS

MAX_OF_A_PAGE = 32 * MB
"""Memory of the handover of a page that has ended; a longer history keeps its newest steps."""
MAX_BYTES = 256 * MB
"""Memory of all of these together."""

GONE = "The undo history and the selection of this page are no longer on the server."
CHANGED = "The file has changed, so its undo history and its selection were dropped."

PLAIN = (param.Boolean, param.Selector, param.Number, param.String)
"""Kinds of tools' parameters that hold for any mesh."""


@dataclass(frozen=True)
class Handover:
    """State that the next page takes over from a page, besides its address.

    Parameters
    ----------
    history : History
        Put away: the next page reads the character again.
    step : int
        The step of the lesson.
    tools : mapping
        Values of the state: the plain tools, and the chosen layer.
    chosen : array, shape (n,), bool, optional
        The selected vertices.
    listed : mapping of str to str
        Keys and names of uploads in the list of characters.
    contents : tuple
        Fingerprint of a character of this machine, whose file may change; else empty.
    before_lesson : BeforeLesson or None
    """

    history: History
    step: int
    tools: Mapping[str, Any]
    chosen: NDArray[np.bool_] | None
    listed: Mapping[str, str]
    contents: tuple[Any, ...]
    before_lesson: BeforeLesson | None

    def shows(self, request: Request) -> bool:
        """Return whether a request is for the character, and the step, that the page shows."""
        now, step = self.history.now, request.arrival.get("step", -1)
        return now is not None and (now.source, self.step) == (request.source, step)


def handover_of(session: Session) -> Handover | None:
    """Return what the next page takes over; None if nothing can be opened again."""
    state, before = session.state, session.before_lesson
    if state.own is None or not session.source:
        return None
    if before is not None:
        before = replace(
            before,
            history=before.history.put_away(),
            document=before.document.put_away(),
            tools=_plain(state, before.tools),
        )
    return Handover(
        history=session.history.put_away(),
        step=state.step,
        tools={**_plain(state, state.param.values()), "layer": state.layer},
        chosen=selected(state),
        listed=dict(session.uploads.listed),
        contents=_contents(state.own) if session.source == "~" else (),
        before_lesson=before,
    )


def _plain(state: State, values: Mapping[str, Any]) -> dict[str, Any]:
    names = [name for name in state.tools if isinstance(state.param[name], PLAIN)]
    return {name: values[name] for name in names}


def _contents(own: Rig) -> tuple[Any, ...]:
    weights = np.ascontiguousarray([] if own.weights is None else own.weights)
    digest = hashlib.blake2b(weights.data).digest()
    return (*data_fingerprint(own.mesh, own.skeleton).values(), digest)


@dataclass
class _Ended:
    """Handover of a page that has ended: a pickle, and its arrays, which are not copied."""

    pickled: bytes
    arrays: list[pickle.PickleBuffer]
    ended: float
    is_taken: bool = False

    @property
    def size(self) -> int:
        return len(self.pickled) + sum(one.raw().nbytes for one in self.arrays)


class Pages:
    """The pages that a reload can continue: those that are open, and those that ended lately."""

    def __init__(
        self,
        seconds: float = STORED_SECONDS,
        most: int = MAX_BYTES,
        most_of_a_page: int = MAX_OF_A_PAGE,
    ) -> None:
        self._seconds, self._most, self._most_of_a_page = seconds, most, most_of_a_page
        self._lock = threading.Lock()
        self._open: WeakValueDictionary[str, Session] = WeakValueDictionary()
        self._ended: dict[str, _Ended] = {}

    @property
    def size(self) -> int:
        """Bytes of all handovers of pages that have ended."""
        return sum(one.size for one in self._ended.values())

    def enter(self, session: Session) -> str:
        """Return the key of a new page, which its browser learns once it shows a character."""
        key = secrets.token_urlsafe(16)
        with self._lock:
            self._open[key] = session
        # Until then its tab names the page that this one continues.
        session.state.param.watch(lambda event: session.view.send(page=key), "own")
        return key

    def leave(self, key: str) -> None:
        """Store the handover of a page that is about to end; the newest steps if it is large."""
        with self._lock:
            session = self._open.pop(key, None)
            handover = None if session is None else handover_of(session)
            if handover is None:
                return
            ended = _packed(handover)
            while ended.size > self._most_of_a_page and handover.history.shorten():
                ended = _packed(handover)
            if ended.size <= self._most_of_a_page:
                self._ended[key] = ended
            self._sweep()

    def find(self, key: str) -> Handover | None:
        """Return a copy of the handover of a page; None if it is not stored any more."""
        with self._lock:
            self._sweep()
            session, ended = self._open.get(key), self._ended.get(key)
            if session is not None:
                return handover_of(session)
            if ended is None:
                return None
            ended.is_taken = True
            handover: Handover = pickle.loads(ended.pickled, buffers=ended.arrays)
            return handover

    def sweep(self) -> None:
        """Remove old handovers."""
        with self._lock:
            self._sweep()

    def _sweep(self) -> None:
        """Remove old handovers; beyond the limit first those that were taken, then the oldest."""
        old = time.monotonic() - self._seconds
        self._ended = {key: one for key, one in self._ended.items() if one.ended > old}
        size = self.size
        order = sorted(self._ended.items(), key=lambda item: (not item[1].is_taken, item[1].ended))
        for key, one in order:
            if size <= self._most:
                break
            del self._ended[key]
            size -= one.size


PAGES = Pages()
"""The pages of this server."""


def _packed(handover: Handover) -> _Ended:
    arrays: list[pickle.PickleBuffer] = []
    pickled = pickle.dumps(handover, 5, buffer_callback=arrays.append)
    return _Ended(pickled, arrays, time.monotonic())


def arrive(session: Session, query: str, first: Request, pages: Pages = PAGES) -> None:
    """Open what an address says, and continue the page before where it showed the same."""
    key, request = session.view.page_before, loading.arrival(session, query, first)
    handover = pages.find(key) if key else None
    if handover is not None and handover.shows(request):
        session.paths = first.paths
        session.uploads.list_again(handover.listed)
        request = _continued(session, request, handover)
    elif handover is None and key and {"edits", "repairs"} & request.arrival.keys():
        request = replace(request, message=f"{request.message} {GONE}".strip())
    loading.open_character(session, request)


def _continued(session: Session, request: Request, handover: Handover) -> Request:
    """Return a request for the document of the page before."""

    def note(now: Document) -> None:
        session.history, session.before_lesson = handover.history, handover.before_lesson
        session.history.replace_current(now)

    def select() -> None:
        if handover.chosen is not None:
            session.state.brush_selection = Selection(session.state.rig.mesh, handover.chosen)

    def instead(own: Rig) -> Request | None:
        if not handover.contents or handover.contents == _contents(own):
            return None
        return replace(request, rig=own, message=f"{request.message} {CHANGED}".strip())

    choices = {**request.choices, **handover.tools}
    document = handover.history.now
    return replace(
        request, choices=choices, document=document, note=note, then=select, instead=instead
    )
