"""Reading of an address: its character, and the choices in it."""

from collections.abc import Callable

from cutcell_assets import DEMOS

from ..messages.received import Visit
from ..server.messages import visible_text
from .address import defaults, from_query, with_scene
from .loading import load_demo, load_files
from .recording import restore
from .session import Session

GONE = (
    "The uploaded character of this link is no longer on the server. Drop the file again to "
    "continue."
)


GREETING = "pose"
"""The panel that a page begins with whose address says nothing: there the character moves."""


def watch(session: Session) -> None:
    """Go back and on to addresses of this page, as the browser's buttons say."""

    def visit(message: Visit) -> None:
        restore(session, defaults(session.state))
        arrive(session, message.query, lambda: None)
        session.arrival.setdefault("step", -1)  # the entry that is left may be a step

    session.view.listen(Visit, visit)


def show_first_demo(session: Session, demo: str) -> None:
    """Show the first character as it moves, in the colours of its weights."""

    def chosen() -> None:
        moves = bool(session.state.rig.clips) and not session.view.calm
        session.state.param.update(moving=moves, playing=moves)

    load_demo(session, demo, chosen)


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


def arrive(session: Session, query: str, fallback: Callable[[], None]) -> None:
    """Show what an address says; `fallback` loads a character where it names none that exists."""
    choices, arrival, problems = from_query(with_scene(query, session.state), session.state)
    session.state.param.update(**choices)
    session.arrival = arrival
    rig = arrival.get("rig", "")
    uploaded = session.uploads.take(rig[1:]) if rig.startswith("~") else None
    demo = any(demo.id == rig and demo.path.exists() for demo in DEMOS)
    if rig and not rig.startswith("~") and not demo:
        problems.append(f"rig={rig}"[:60])
    if rig.startswith("~") and uploaded is None:
        arrival["notice"] = GONE
    elif problems:
        arrival["notice"] = (
            f"Unknown settings in the link were ignored: {visible_text(', '.join(problems))}."
        )
    if uploaded is not None:
        load_files(session, uploaded, rig[1:])
    elif demo:
        load_demo(session, rig)
    else:
        fallback()
