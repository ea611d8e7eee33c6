"""Commands that open a character: a demo, files, or one of the history."""

from functools import partial
from pathlib import Path
from typing import Any

from cutcell.rig import Rig

from ..files.receive import Receiver
from ..files.upload_cache import Group
from .opening import Opening, Request, commit
from .recording import restore
from .session import Session


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
    repair = document.repair
    if is_open and (repair is None or repair.after is not None):
        history.go(by, document)
        restore(session, document)
        return None
    return Request(document.source, document=document, note=partial(history.go, by))


def receiver(session: Session) -> Receiver:
    """Return what takes files from the browser and loads them."""
    uploads = session.uploads
    made = Receiver(uploads.cache, uploads, lambda group: load_upload(session, group), session.fail)
    uploads.when_closed(made.drop)
    return made
