"""Commands that open a character: of an address, a demo, files, or one of the history."""

from collections.abc import Callable
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any

from cutcell.errors import FileError
from cutcell.rig import Rig
from cutcell_assets import DEMOS

from ..files.receive import Receiver
from ..files.upload_cache import Group
from ..server.messages import visible_text
from ..server.protocol.received import Visit
from .address import from_query, with_scene
from .opening import Opening, Request, commit
from .recording import restore
from .session import Session

GONE = (
    "The uploaded character of this link is no longer on the server. Drop the file again to "
    "continue."
)


GREETING = "pose"
"""The panel that a page begins with whose address says nothing: there the character moves."""


def open_character(session: Session, request: Request) -> None:
    """Open what a request says; it takes the place of what is being opened."""
    session.tasks.add(Opening(session, lambda: request))


def load_demo(session: Session, id: str) -> None:
    """Show a demo character and bind it."""
    open_character(session, Request(f"demo {id}", again=True))


def load_files(session: Session, paths: list[Path]) -> None:
    """Show the character in some files of this machine, and bind it."""
    open_character(session, Request("~", paths=paths, again=True))


def load_upload(session: Session, group: Group) -> None:
    """Show the character in files that a person dropped; they are kept for a while."""
    session.uploads.hold(group.key)
    open_character(session, Request(f"~{group.key}", again=True))


def load_again(session: Session, source: str) -> None:
    """Show a character that was open before, by its key; see `Document`."""
    open_character(session, Request(source, again=True))


def show_rig(session: Session, rig: Rig, source: str = "", **arrival: Any) -> None:
    """Show a character that is loaded already, and bind it, as an address says."""
    commit(session, Request(source, arrival=arrival), rig)


def travel(session: Session, by: int) -> None:
    """Go some steps of the history, backwards if negative, also to another character.

    Where a person has started something, that is done before.
    """
    session.tasks.add(Opening(session, partial(_step, session, by), supersedes=False))


def _step(session: Session, by: int) -> Request | None:
    """Return to a document of the open character at once; else return what opens the other."""
    history = session.history
    document = history.peek(by)
    if document is None:
        return None
    is_open = document.source == session.source
    if is_open and document.repair == session.state.repair:
        document = replace(document, repair=session.state.repair)  # with what it makes
    repair = document.repair
    if is_open and (repair is None or repair.after is not None):
        history.go(by, document)
        restore(session, document)
        return None
    return Request(document.source, document=document, note=partial(history.go, by))


def receiver(
    session: Session, received: Callable[[Session, Group], None] = load_upload
) -> Receiver:
    """Return what takes files from the browser, and loads them unless something else is said."""
    uploads = session.uploads
    made = Receiver(uploads.cache, uploads, partial(received, session), session.fail)
    uploads.when_closed(made.drop)
    return made


def watch(session: Session) -> None:
    """Go back and on to addresses of this page, as the browser's buttons say."""
    session.view.listen(Visit, lambda message: visit(session, message.query))


def visit(session: Session, query: str) -> None:
    """Open an address of this page, with nothing else chosen; or nothing changes."""

    def request() -> Request:
        source, choices, arrival, problem = _read(session, query)
        if source == "":
            raise FileError(problem)
        return Request(
            source or ("~" if session.paths else session.source),
            fresh=True,
            choices=choices,
            arrival={"step": -1, **arrival},  # the entry that is left may be a step
            message=problem,
        )

    session.tasks.add(Opening(session, request))


def choose(session: Session, query: str, first: str = "") -> None:
    """Choose what an address says, before any character is there.

    `first` is the demo that is to come where the address names none; empty for none.
    """
    state = session.state
    choices, arrival, _ = from_query(with_scene(query, state), state)
    if first and not query:
        choices["panel"] = GREETING
    demo = arrival.get("rig", first)
    demo_ids = {demo.id for demo in DEMOS if demo.path.exists()}
    state.param.update(**choices, demo=demo if demo in demo_ids else "")


def arrive(session: Session, query: str, first: Request | None = None) -> None:
    """Open what an address says; see `arrival`."""
    open_character(session, arrival(session, query, first))


def arrival(session: Session, query: str, first: Request | None = None) -> Request:
    """Return what an address says; `first` where it names no character that exists."""
    source, choices, arrival, problem = _read(session, query)
    first = first or Request(session.source)
    if source:
        return Request(source, choices=choices, arrival=arrival, message=problem)
    if source is None:  # what it says is about the first character
        first = replace(first, arrival={**first.arrival, **arrival})
    return replace(first, choices=choices, message=problem)


def _read(session: Session, query: str) -> tuple[str | None, dict[str, Any], dict[str, Any], str]:
    """Read an address.

    Returns the key of its character, None if it names none and "" if that cannot be opened; what
    `from_query` returns of it; and what is wrong with it, in a sentence.
    """
    state = session.state
    choices, arrival, problems = from_query(with_scene(query, state), state)
    rig = arrival.pop("rig", None)
    source, problem = rig, ""
    if rig and rig.startswith("~"):
        if not session.uploads.cache.has(rig[1:]):
            source, problem = "", GONE
    elif any(demo.id == rig and demo.path.exists() for demo in DEMOS):
        source = f"demo {rig}"
    elif rig:
        source = ""
        problems.append(f"rig={rig}"[:60])
    if problems and not problem:
        named = visible_text(", ".join(problems))
        problem = f"Unknown settings in the link were ignored: {named}."
    return source, choices, arrival, problem
