"""How a character comes to stand on the page: a demo, or files."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

from param.parameterized import batch_call_watchers

from cutcell.editing.corrections import Corrections
from cutcell.errors import CutcellError, FileError, ParameterError
from cutcell.rig import Rig
from cutcell.runtime.progress import Progress
from cutcell_assets import DEMOS
from cutcell_viewers.camera import Camera, framing

from ..files.reading import demo_rig, main_file, read
from ..files.receive import Receiver
from ..files.upload_cache import Group
from ..jobs.jobs import READING
from ..scenes.common import bones_part, bounds_of, camera_part, first_joint
from ..state.url import first_clip
from . import history
from .binding import bind, restore, resume
from .compare import carry
from .correct import corrected_state
from .look import set_camera
from .session import Session


def load_demo(
    session: Session,
    id: str,
    chosen: Callable[[], None] = lambda: None,
    then: Callable[[], None] = lambda: None,
) -> None:
    """Show a demo character and bind it.

    Parameters
    ----------
    session : Session
    id : str
    chosen : callable
        Chooses more, together with the character.
    then : callable
        Called when the character is open.
    """
    session.state.demo = id
    title = next(demo.title for demo in DEMOS if demo.id == id)
    _load(
        session,
        lambda check: demo_rig(id),
        f"loading {title}",
        lambda: session.uploads.stay(""),
        f"demo {id}",
        chosen,
        then,
    )


def load_files(
    session: Session,
    paths: list[Path],
    key: str = "",
    chosen: Callable[[], None] = lambda: None,
) -> None:
    """Show the character in some files, and bind it.

    Parameters
    ----------
    session : Session
    paths : list of Path
        The file, and those that belong to it.
    key : str
        That of uploaded files; see `UploadCache`. Without one they are files of this machine.
    chosen : callable
        Chooses more, together with the character.
    """
    uploads = session.uploads
    if not key:
        session.given = paths
    try:
        path = main_file(paths)
    except CutcellError as error:
        session.fail(error)
        uploads.leave(key)
        return
    _load(
        session,
        lambda check: read(path, check),
        f"loading {path.name}",
        lambda: uploads.stay(key, path.name),
        f"~{key}",
        chosen,
        failed=lambda: uploads.leave(key),
        demo="",
    )


def load_upload(session: Session, group: Group) -> None:
    """Show the character in files that a person dropped; they are kept for a while."""
    session.arrival = {}  # the address describes another character
    session.uploads.hold(group.key)
    load_files(session, group.paths, group.key)


def load_again(session: Session, character: str, chosen: Callable[[], None] = lambda: None) -> None:
    """Show a character that stood there before.

    Parameters
    ----------
    session : Session
    character : str
        As `Session.character` was then.
    chosen : callable
        Chooses more, together with the character.
    """
    kind, _, demo = character.partition(" ")
    if kind == "demo":
        load_demo(session, demo, chosen)
        return
    key = character[1:]
    paths = session.uploads.take(key) if key else session.given
    if paths is None:
        name = session.uploads.listed.pop(key, "that character")
        session.fail(FileError(f"the server no longer has the files of {name}; drop them again"))
        session.state.param.trigger("demo")
    else:
        load_files(session, paths, key, chosen)


def revisit(session: Session, choices: dict[str, Any] | None) -> None:
    """Return to choices of the history, and to their character; None for nothing."""
    if not choices:
        return
    arriving = session.state.demo != session.character.partition(" ")[2]
    if not arriving and choices.get("character", session.character) == session.character:
        restore(session, choices)
        return
    # The other character is opened as its file has it.
    session.history.drop(history.RESULT)
    chosen = {n: v for n, v in history.plain(choices).items() if n not in history.RESULT}

    def choose() -> None:
        session.returning = True
        with history.restoring(session):
            session.state.param.update(**chosen)

    load_again(session, choices["character"], choose)


def receiver(session: Session) -> Receiver:
    """Return what takes files from the browser and loads them."""
    uploads = session.uploads
    made = Receiver(uploads.cache, uploads, lambda group: load_upload(session, group), session.fail)
    uploads.when_closed(made.drop)
    return made


def show_rig(
    session: Session, rig: Rig, chosen: Callable[[], None] = lambda: None, character: str = ""
) -> None:
    """Show a character that is loaded already, and bind it.

    Parameters
    ----------
    session : Session
    rig : Rig
    chosen : callable
        Chooses more, together with the character.
    character : str
        See `Session.character`.
    """
    state, view = session.state, session.view
    old, session.character = session.character, character
    session.tasks.jobs("field").cancel()
    before, arrival, session.arrival = state.rig, session.arrival, {}
    # All at once: a menu whose value changes twice in a moment may tell the first one back.
    with history.restoring(session), batch_call_watchers(state):
        state.param.update(
            rig=rig, binding=None, bare_graph=None, field=None, turns={}, moving=False,
            playing=False, repair=None, corrections=Corrections(), part=None, brush=False,
            joint_handle=False,
            own=rig,
            clip=first_clip(rig), message=None, joint=first_joint(rig), vertex=None,
        )  # fmt: skip
        _arrive(session, rig, arrival)
        carry(state, before, arrival)
        chosen()
        _correct(session, arrival.get("corrections", ""))
        _choose_joints(session, arrival)
        if not state.is_panel_usable:
            state.panel = "graph"
    view.camera = framing(bounds_of(state), 1.2)
    view.at_home = True
    view.send(bones=bones_part(state), camera=camera_part(view.camera))
    if "camera" in arrival:
        eye, target = arrival["camera"][:3], arrival["camera"][3:]
        set_camera(session, Camera(tuple(eye), tuple(target)))
    history.begin(session, old)
    session.drop_exports()
    bind(session, state.message)


def _load(
    session: Session,
    load: Callable[[Callable[[], object]], Rig],
    stage: str,
    loaded: Callable[[], None],
    character: str,
    chosen: Callable[[], None] = lambda: None,
    then: Callable[[], None] = lambda: None,
    failed: Callable[[], None] = lambda: None,
    **more: Any,
) -> None:
    def work(progress: Progress) -> Rig:
        progress(stage, 0.0)
        return load(lambda: progress(stage, 0.0))

    def done(rig: Rig) -> None:
        loaded()
        session.state.param.update(**more)
        show_rig(session, rig, chosen, character)
        then()

    def went_wrong() -> None:
        failed()
        resume(session)

    session.start(work, done, READING, went_wrong)


def _correct(session: Session, text: str) -> None:
    """Take the corrections that an address says, or that are chosen already, if they fit."""
    state, corrections = session.state, session.state.corrections
    try:
        if text:
            stored = session.kept.read(text)
            if stored is None:
                raise ParameterError("the server no longer has them")
            corrections = stored
        changed = corrected_state(session, corrections)
        if "joint" in changed:  # the choices already refer to the corrected skeleton
            changed = {k: v for k, v in changed.items() if k not in ("joint", "turns")}
            if text:
                changed["joint"] = first_joint(changed["rig"])
        state.param.update(**changed)
    except (CutcellError, ValueError) as error:
        state.corrections = Corrections()
        session.binder.notice = f"The corrections of this address were not taken: {error}"


def _arrive(session: Session, rig: Rig, arrival: dict[str, Any]) -> None:
    """Choose what an address says of the character."""
    state = session.state
    if -1 <= arrival.get("clip", -2) < len(rig.clips):
        state.clip = arrival["clip"]
    state.tour = arrival.get("tour", state.tour)
    if 0 <= arrival.get("vertex", -1) < len(rig.mesh.vertices):
        state.vertex = arrival["vertex"]
    session.binder.notice = arrival.get("told", "")


def _choose_joints(session: Session, arrival: dict[str, Any]) -> None:
    """Choose what an address says of joints, which corrections may have brought."""
    state = session.state
    names = state.rig.skeleton.names
    if arrival.get("bone") in names:
        state.joint = names.index(arrival["bone"])
    if "turns" in arrival:
        state.turns = {j: t for j, t in arrival["turns"].items() if j < len(names)}
