"""Open a character: a demo, or files."""

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

from param.parameterized import batch_call_watchers

from cutcell.editing import Edits, edited_rig
from cutcell.editing.stored import stored_edits
from cutcell.errors import CutcellError, FileError, ParameterError
from cutcell.rig import Rig
from cutcell.runtime.progress import Progress
from cutcell_assets import DEMOS
from cutcell_viewers.camera import Camera, framing

from ..derive.jobs import READING
from ..files.reading import demo_rig, main_file, read
from ..files.receive import Receiver
from ..files.upload_cache import Group
from . import recording as history
from .address import first_clip
from .edits import changes, edited_state, same_structure
from .framing import bounds_of, camera_part, first_joint
from .look import set_camera
from .method import chosen_by
from .session import Session
from .side_by_side import carry


def load_demo(
    session: Session,
    id: str,
    chosen: Callable[[], None] = lambda: None,
    then: Callable[[], None] = lambda: None,
) -> None:
    """Show a demo character and bind it.

    `chosen` chooses more, together with the character; `then` is called when it is open.
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
    session: Session, paths: list[Path], key: str = "", chosen: Callable[[], None] = lambda: None
) -> None:
    """Show the character in some files, and bind it; `chosen` chooses more, together with it.

    Without a key, see `UploadCache`, they are files of this machine.
    """
    uploads = session.uploads
    if not key:
        session.paths = paths
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
    """Show a character that was open before, by its `Session.character`."""
    kind, _, demo = character.partition(" ")
    if kind == "demo":
        load_demo(session, demo, chosen)
        return
    key = character[1:]
    paths = session.uploads.take(key) if key else session.paths
    if paths is None:
        name = session.uploads.listed.pop(key, "that character")
        session.refuse(
            FileError(f"the server no longer has the files of {name}; drop them again"), "demo"
        )
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


def restore(session: Session, choices: dict[str, Any]) -> None:
    """Choose again what was chosen once of the open character."""
    state, plain = session.state, history.plain(choices)
    edits: Edits = choices.get("edits") or state.edits
    own = choices.get("own") or state.own
    rig = choices.get("rig") or edited_rig(own, edits)
    changed: dict[str, Any] = {"rig": rig}
    if not same_structure(rig, state.rig):
        changed = changes(state, rig, edits)
    if rig.mesh is not state.rig.mesh:
        changed |= {"vertex": None, "message": None}
    history.restore(session, {**changed, **plain, "own": own})
    history.publish(session)


def receiver(session: Session) -> Receiver:
    """Return what takes files from the browser and loads them."""
    uploads = session.uploads
    made = Receiver(uploads.cache, uploads, lambda group: load_upload(session, group), session.fail)
    uploads.when_closed(made.drop)
    return made


def show_rig(
    session: Session, rig: Rig, chosen: Callable[[], None] = lambda: None, character: str = ""
) -> None:
    """Show a character that is loaded already, and bind it; `chosen` chooses more with it."""
    state, view = session.state, session.view
    old, session.character = session.character, character
    edits, problem = edits_in(rig)
    if not edits and rig.weights is not None and character.startswith("~"):
        edits = Edits(base="file")  # a person's own file is to be mended, a demo to be computed
    before, arrival, session.arrival = state.rig, session.arrival, {}
    # All at once: a menu whose value changes twice in a moment may tell the first one back.
    with history.restoring(session), batch_call_watchers(state):
        state.param.update(
            rig=rig, turns={}, moving=False,
            playing=False, repair=None, edits=replace(edits, method={}), part=None, brush=False,
            layer=None, opening=edits,
            joint_handle=False,
            own=rig,
            clip=first_clip(rig), message=None, joint=first_joint(rig), vertex=None,
        )  # fmt: skip
        _arrive(session, rig, arrival)
        state.param.update(**({} if "edits" in arrival else chosen_by(edits.method)))
        carry(state, before, arrival)
        chosen()
        _correct(session, arrival.get("edits", ""))
        _choose_joints(session, arrival)
        if not state.is_panel_usable:
            state.panel = "graph"
    view.camera = framing(bounds_of(state), 1.2)
    view.at_home = True
    view.send(camera=camera_part(view.camera))
    if "camera" in arrival:
        eye, target = arrival["camera"][:3], arrival["camera"][3:]
        set_camera(session, Camera(tuple(eye), tuple(target)))
    history.begin(session, old)
    session.drop_exports()
    if problem:
        session.notice = ("info", problem)


def edits_in(rig: Rig) -> tuple[Edits, str]:
    """Return the edits that a character's file holds, and why they are not applied, if so."""
    try:
        edits = stored_edits(rig) or Edits()
        edited_rig(rig, edits)
    except CutcellError as error:
        return Edits(), f"The layers of the file were not applied: {error}"
    return edits, ""


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

    session.work.start("character", work, done, failed, READING)


def _correct(session: Session, text: str) -> None:
    """Take the edits that an address holds, or that are chosen already, if they fit."""
    state, edits = session.state, session.state.edits
    try:
        if text:
            stored = session.edits_file.read(text)
            if stored is None:
                raise ParameterError("the server no longer has them")
            edits = stored
        changed = edited_state(session.state, edits)
        if "joint" in changed:  # the choices already refer to the edited skeleton
            changed = {k: v for k, v in changed.items() if k not in ("joint", "turns")}
            if text:
                changed["joint"] = first_joint(changed["rig"])
        state.param.update(**changed)
    except (CutcellError, ValueError) as error:
        state.edits = state.first_edits
        text = f"The edits of this address were not applied: {error}"
        session.notice = ("info", text)


def _arrive(session: Session, rig: Rig, arrival: dict[str, Any]) -> None:
    """Choose what an address says of the character."""
    state = session.state
    if -1 <= arrival.get("clip", -2) < len(rig.clips):
        state.clip = arrival["clip"]
    state.step = arrival.get("step", state.step)
    state.staged = arrival.get("stage", state.staged)
    if "step" in arrival:
        others = {step: value for step, value in state.answers.items() if step != state.step}
        answer = {state.step: arrival["answer"]} if "answer" in arrival else {}
        state.answers = {**others, **answer}
    state.param.update(**motion(session, state.panel, arrival))
    if 0 <= arrival.get("vertex", -1) < len(rig.mesh.vertices):
        state.vertex = arrival["vertex"]
    session.notice = ("info", arrival["notice"]) if "notice" in arrival else None


def motion(session: Session, panel: str, arrival: dict[str, Any]) -> dict[str, bool]:
    """Return the motion that an address starts, unless the browser prefers reduced motion."""
    if not arrival.get("playing") or session.view.calm:
        return {}
    names = ("moving", "playing") if session.state.panels[panel].poses else ("animating",)
    return dict.fromkeys(names, True)


def _choose_joints(session: Session, arrival: dict[str, Any]) -> None:
    """Choose what an address says of joints, which edits may have brought."""
    state = session.state
    names = state.rig.skeleton.names
    if arrival.get("bone") in names:
        state.joint = names.index(arrival["bone"])
    if "turns" in arrival:
        state.turns = {j: t for j, t in arrival["turns"].items() if j < len(names)}
