"""Opening of a character: whole, or not at all.

A request says what is to be opened, and all that changes with it. Nothing of the page is touched
until the character is there: then everything is set at once. An error, or a person who cancels,
leaves the page, its address and its history as they were.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

from param.parameterized import batch_call_watchers

from cutcell.editing import Edits
from cutcell.errors import CutcellError, FileError, ParameterError
from cutcell.rig import Rig
from cutcell.runtime.progress import Progress
from cutcell_assets import DEMOS
from cutcell_viewers.camera import Camera, framing

from ..derive.jobs import READING
from ..derive.tasks import Task
from ..files.reading import demo_rig, main_file, read, reported
from . import recording
from .address import camera_of, first_clip, initial
from .document import Document, Repair, applied, put, same_structure
from .edits import edits_in, repaired_again
from .framing import bounds_of, camera_part, first_joint
from .look import set_camera
from .method import chosen_by
from .session import Session
from .side_by_side import carried
from .state import State

LOADING = "load"


@dataclass(frozen=True)
class Request:
    """What is to be opened.

    Parameters
    ----------
    source : str
        Key of the character; see `Document`.
    rig : Rig, optional
        The character, if it is loaded already.
    paths : list of Path, optional
        Files of this machine, for the source "~".
    again : bool
        Whether the file is read though its character is open.
    fresh : bool
        Whether all choices that are not named are the initial ones.
    choices : dict
        Values of the state.
    arrival : dict
        What an address says of the character; see `address.READERS`.
    document : Document, optional
        The document to which a person returns.
    camera : Camera, optional
    note : callable, optional
        Takes the document, and enters it into the history; left out, it is a new step.
    then : callable
        Called when everything is set.
    instead : callable
        Takes the character as its file has it, and returns another request if that is to be opened,
        else None.
    message : str
        What to tell about it.
    """

    source: str
    rig: Rig | None = None
    paths: list[Path] | None = None
    again: bool = False
    fresh: bool = False
    choices: Mapping[str, Any] = field(default_factory=dict)
    arrival: Mapping[str, Any] = field(default_factory=dict)
    document: Document | None = None
    camera: Camera | None = None
    note: Callable[[Document], None] | None = None
    then: Callable[[], None] = lambda: None
    instead: Callable[[Rig], Request | None] = lambda own: None
    message: str = ""


class Opening(Task):
    """Opens what a request says; the request is made when its turn comes.

    Parameters
    ----------
    session : Session
    request : callable
        Returns a `Request`, or None where nothing is to be opened.
    supersedes : bool
        Whether it takes the place of characters that are being opened.
    """

    name, title, slots = LOADING, "another character", READING

    def __init__(
        self, session: Session, request: Callable[[], Request | None], supersedes: bool = True
    ) -> None:
        self._session, self._make_request, self.supersedes = session, request, supersedes
        self._request = Request("")
        self._key = self._name = ""

    def begin(self) -> Callable[[Progress], Any] | None:
        """Open the character if it is at hand; else return what reads it."""
        session, request = self._session, self._make_request()
        if request is None:
            return None
        self._request = request
        is_open = request.source == session.source and not request.again
        own = request.rig or (session.state.own if is_open else None)
        load = self._reader(request) if own is None else reported("repairing", lambda check: own)
        codes, repair = self._repairs(request, own)
        if own is not None and (repair is not None or not codes):
            self.finish((own, repair, ""))
            return None
        document, state = request.document, session.state
        resolution = request.choices.get("resolution", state.resolution)

        def compute(progress: Progress) -> tuple[Rig, Repair | None, str]:
            rig = load(progress)
            if not codes:
                return rig, repair, ""
            edits = edits_in(rig)[0] if document is None else document.edits
            return rig, *repaired_again(rig, codes, edits, resolution, progress)

        return compute

    def _repairs(
        self, request: Request, own: Rig | None
    ) -> tuple[tuple[tuple[str, ...], ...], Repair | None]:
        """Return the codes of the repairs that are to be shown, and the repairs if at hand."""
        state, document = self._session.state, request.document
        if document is None:
            codes = request.arrival.get("repairs", ())
            at_hand = state.repair if own is state.own else None
            return codes, at_hand if at_hand is not None and at_hand.codes == codes else None
        repair = document.repair
        codes = () if repair is None else repair.codes
        return codes, None if repair is None or (codes and repair.after is None) else repair

    def finish(self, result: tuple[Rig, Repair | None, str]) -> None:
        """Open the character that was read."""
        own, repair, problem = result
        other = self._request.instead(own)
        if other is not None:
            self._session.tasks.add(Opening(self._session, lambda: other))
            return
        commit(self._session, self._request, own, repair, problem, self._name)

    def drop(self) -> None:
        """Show the open character in the menu again, and its address in the browser."""
        session = self._session
        session.uploads.leave(self._key)
        session.state.param.trigger("demo")
        recording.publish(session, again=True)

    def _reader(self, request: Request) -> Callable[[Progress], Any]:
        """Return what loads the character."""
        uploads, (kind, _, demo) = self._session.uploads, request.source.partition(" ")
        if kind == "demo":
            title = next(one.title for one in DEMOS if one.id == demo)
            return reported(f"loading {title}", lambda check: demo_rig(demo))
        key = request.source[1:]
        paths = uploads.take(key) if key else request.paths or self._session.paths
        if paths is None:
            name = uploads.listed.pop(key, "that character")
            raise FileError(f"the server no longer has the files of {name}; drop them again")
        self._key = key
        path = main_file(paths)
        self._name = path.name
        return reported(f"loading {path.name}", lambda check: read(path, check))


def commit(
    session: Session,
    request: Request,
    own: Rig,
    repair: Repair | None = None,
    problem: str = "",
    name: str = "",
) -> None:
    """Set everything that a request says, at once.

    The character is `own`, with its repairs; `name` is that of an uploaded file, and `problem` what
    cannot be opened of the rest.
    """
    state, view = session.state, session.view
    values, texts = _values(session, request, own, repair)
    is_other = own is not state.own
    with session.history.restoring(), batch_call_watchers(state):
        session.source = request.source
        session.paths = request.paths or session.paths
        session.uploads.stay(request.source.partition("~")[2], name)
        put(state, **values)
    view.camera, view.at_home = framing(bounds_of(state), 1.2), True
    view.send(camera=camera_part(view.camera))
    numbers = request.arrival.get("camera")
    camera = request.camera or (camera_of(numbers) if numbers else None)
    if camera is not None:
        set_camera(session, camera)
    (request.note or session.history.open)(recording.present(session))
    recording.publish(session)
    texts = [text for text in (request.message, problem, *texts) if text]
    if texts:
        state.message = ("info", " ".join(texts))
    if is_other:
        session.drop_exports()
    request.then()


def _values(
    session: Session, request: Request, own: Rig, repair: Repair | None
) -> tuple[dict[str, Any], list[str]]:
    """Return the values of the state for a character, and what could not be applied."""
    state, arrival, document = session.state, request.arrival, request.document
    opening, problem = edits_in(own)
    if not opening and own.weights is not None and request.source.startswith("~"):
        opening = Edits(base="file")  # a person's own file is to be mended, a demo to be computed
    first = replace(opening, method={})
    edits, texts = (first if document is None else document.edits), [problem]
    try:
        if document is None and "edits" in arrival:
            edits = _stored(session, arrival["edits"])
        rig = _rig(state, own, repair, edits)
    except (CutcellError, ValueError) as error:
        texts.append(f"The edits of this address were not applied: {error}")
        edits, rig = first, _rig(state, own, repair, first)
    stays = own is state.own and not request.again and same_structure(rig, state.rig)
    values: dict[str, Any] = {
        "demo": request.source.partition("demo ")[2],
        "own": own, "repair": repair, "edits": edits, "rig": rig, "opening": opening,
        "turns": {}, "moving": False, "playing": False, "part": None, "brush": False,
        "layer": None, "joint_handle": False, "moved": None, "clip": first_clip(own),
        "joint": state.joint if stays else first_joint(rig), "vertex": None, "message": None,
    }  # fmt: skip
    if request.fresh:
        values |= {**initial(state), "node": None, "animating": False}
    if "edits" not in arrival:
        values |= chosen_by(opening.method)
    values |= carried(state, own, opening.base, request.fresh, arrival)
    values |= request.choices
    panel = values.get("panel", state.panel)
    values |= _arrived(session, rig, panel, arrival)
    if document is not None:
        values |= document.choices
    shown = state.panels[values.get("panel", panel)]
    if not len(rig.skeleton.joints) and not shown.works_without_skeleton:
        values["panel"] = "graph"
    return values, texts


def _stored(session: Session, text: str) -> Edits:
    """Return the edits that an address holds."""
    edits = session.edits_file.read(text)
    if edits is None:
        raise ParameterError("the server no longer has them")
    return edits


def _rig(state: State, own: Rig, repair: Repair | None, edits: Edits) -> Rig:
    """Return the rig of a document, which is the open one where nothing of it differs."""
    shown: Rig = state.rig
    is_open = own is state.own and repair == state.repair and edits == state.edits
    return shown if is_open else applied(own, repair, edits)


def _arrived(session: Session, rig: Rig, panel: str, arrival: Mapping[str, Any]) -> dict[str, Any]:
    """Return what an address says of a character, as values of the state."""
    state, names = session.state, list(rig.skeleton.names)
    values: dict[str, Any] = {}
    if -2 <= arrival.get("clip", -3) < len(rig.clips):
        values["clip"] = arrival["clip"]
    if 0 <= arrival.get("vertex", -1) < len(rig.mesh.vertices):
        values["vertex"] = arrival["vertex"]
    if arrival.get("bone") in names:
        values["joint"] = names.index(arrival["bone"])
    if "turns" in arrival:
        values["turns"] = {j: t for j, t in arrival["turns"].items() if j < len(names)}
    if "stage" in arrival:
        values["staged"] = arrival["stage"]
    if "step" in arrival:
        step = values["step"] = arrival["step"]
        others = {key: value for key, value in state.answers.items() if key != step}
        answer = {step: arrival["answer"]} if "answer" in arrival else {}
        values["answers"] = {**others, **answer}
    return {**values, **motion(session, panel, arrival)}


def motion(session: Session, panel: str, arrival: Mapping[str, Any]) -> dict[str, bool]:
    """Return the motion that an address starts, unless the browser prefers reduced motion."""
    if not arrival.get("playing") or session.view.calm:
        return {}
    names = ("moving", "playing") if session.state.panels[panel].poses else ("animating",)
    return dict.fromkeys(names, True)
