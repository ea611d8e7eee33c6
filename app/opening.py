"""How a character comes to stand on the page: a demo, files, or what an address says."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any

from param.parameterized import batch_call_watchers

from assets import DEMOS
from cutcell.errors import CutcellError
from cutcell.progress import Progress
from cutcell.rig import Rig
from viewers.camera import Camera, framing

from .actions import compare, learn
from .choices import first_clip, from_query
from .jobs import READING
from .keep import KEEP, Group
from .messages import shown
from .reading import demo_rig, main_file, read
from .scenes.common import bones_part, bounds_of, first_joint
from .upload import Receiver
from .view import camera_part

if TYPE_CHECKING:
    from .session import Session

GONE = (
    "The character of this address was uploaded, and the server no longer has it; here is "
    "another. Drop the file again to go on with it."
)


class Opening:
    """Opens the characters of a session.

    Parameters
    ----------
    session : Session

    Attributes
    ----------
    kept : str
        The key of the uploaded character that stands there; empty for any other.
    """

    def __init__(self, session: Session) -> None:
        self._session = session
        self.kept = ""
        self._held: set[str] = set()
        self._owner = object()
        self._receivers: list[Receiver] = []
        self._told = ""
        self._arrival: dict[str, Any] = {}

    def demo(
        self,
        id: str,
        chosen: Callable[[], None] = lambda: None,
        then: Callable[[], None] = lambda: None,
    ) -> None:
        """Show a demo character and bind it.

        Parameters
        ----------
        id : str
        chosen : callable
            Chooses more, together with the character.
        then : callable
            Called when it stands there.
        """
        self._session.state.demo = id
        title = next(demo.title for demo in DEMOS if demo.id == id)
        self._open(
            lambda wanted: demo_rig(id), f"opening {title}", lambda: self._keep(""), chosen, then
        )

    def files(self, paths: list[Path], key: str = "") -> None:
        """Show the character in some files, and bind it.

        Parameters
        ----------
        paths : list of Path
            The file, and those that belong to it.
        key : str
            That of kept files, if they are; see `keep`.
        """
        try:
            path = main_file(paths)
        except CutcellError as error:
            self._session.fail(error)
            self._leave(key)
            return
        self._open(
            lambda wanted: read(path, wanted),
            f"opening {path.name}",
            lambda: self._keep(key),
            failed=lambda: self._leave(key),
            demo="",
        )

    def upload(self, group: Group) -> None:
        """Show the character in files that a person dropped; they are kept for a while."""
        self._arrival = {}  # what an address says is of another character
        self._held.add(group.key)
        self.files(group.paths, group.key)

    def choose(self, query: str, first: str = "") -> None:
        """Choose what an address says, before any character is there.

        Parameters
        ----------
        query : str
        first : str
            The demo that is to come where it says nothing of that; empty for none.
        """
        state = self._session.state
        choices, arrival, _ = from_query(query, state)
        demo = learn.demo_of(arrival) if learn.opens(arrival) else arrival.get("rig", first)
        known = {demo.id for demo in DEMOS if demo.path.exists()}
        state.param.update(**choices, demo=demo if demo in known else "")

    def arrive(self, query: str, otherwise: Callable[[], None]) -> None:
        """Show what an address says.

        Parameters
        ----------
        query : str
        otherwise : callable
            Opens a character where the address names none that is there.
        """
        choices, arrival, problems = from_query(query, self._session.state)
        self._session.state.param.update(**choices)
        self._arrival = arrival
        rig = arrival.get("rig", "")
        kept = KEEP.take(rig[1:]) if rig.startswith("~") else None
        demo = any(demo.id == rig and demo.path.exists() for demo in DEMOS)
        if rig and not rig.startswith("~") and not demo:
            problems.append(f"rig={rig}"[:60])
        if rig.startswith("~") and kept is None:
            arrival["told"] = GONE
        elif problems:
            arrival["told"] = (
                f"The address says what this page does not know ({shown(', '.join(problems))}); "
                "the rest of it was taken."
            )
        if learn.opens(arrival):
            learn.go(self._session, arrival["tour"], frozenset({**choices, **arrival}))
        elif kept is not None:
            self._held.add(rig[1:])
            self.files(kept, rig[1:])
        elif demo:
            self.demo(rig)
        else:
            otherwise()

    def take_note(self) -> str:
        """Return what is to be told of the character's arrival, once; empty for nothing."""
        told, self._told = self._told, ""
        return told

    def stay(self) -> None:
        """Let go of what was to stand there instead of the character that does."""
        self._keep(self.kept)

    def close(self) -> None:
        """Let go of what was uploaded, and of what is still being sent."""
        self._keep("")
        for receiver in self._receivers:
            receiver.drop()

    def _keep(self, key: str) -> None:
        self.kept = key
        for other in self._held - {key}:
            self._leave(other)

    def _leave(self, key: str) -> None:
        if key in self._held and key != self.kept:
            self._held.remove(key)
            KEEP.leave(key)

    def receiver(self) -> Receiver:
        """Return what takes files from the browser and opens them."""
        receiver = Receiver(KEEP, self._owner, self.upload, self._session.fail)
        self._receivers.append(receiver)
        return receiver

    def rig(self, rig: Rig) -> None:
        """Show a character that is loaded already, and bind it."""
        self._session.state.demo = ""
        self._stand(rig)

    def swap(self, rig: Rig) -> None:
        """Show the same character with other faces or weights, and bind it; all choices stay."""
        session = self._session
        session.jobs("field").cancel()
        session.state.param.update(
            rig=rig, binding=None, bare_graph=None, field=None, vertex=None, message=None
        )
        session.bind()

    def _open(
        self,
        load: Callable[[Callable[[], object]], Rig],
        stage: str,
        opened: Callable[[], None] = lambda: None,
        chosen: Callable[[], None] = lambda: None,
        then: Callable[[], None] = lambda: None,
        failed: Callable[[], None] = lambda: None,
        **more: Any,
    ) -> None:
        def work(progress: Progress) -> Rig:
            progress(stage, 0.0)
            return load(lambda: progress(stage, 0.0))

        def done(rig: Rig) -> None:
            opened()
            self._session.state.param.update(**more)
            self._stand(rig, chosen)
            then()

        self._session.start(work, done, READING, failed)

    def _stand(self, rig: Rig, chosen: Callable[[], None] = lambda: None) -> None:
        session = self._session
        state, view = session.state, session.view
        session.jobs("field").cancel()
        before, arrival, self._arrival = state.rig, self._arrival, {}
        # All at once: a menu whose value changes twice in a moment may tell the first one back.
        with batch_call_watchers(state):
            state.param.update(
                rig=rig, binding=None, bare_graph=None, field=None, turns={}, moving=False,
                playing=False,
                clip=first_clip(rig), message=None, joint=first_joint(rig), vertex=None,
            )  # fmt: skip
            if state.bare:
                state.panel = "graph"
            self._land(rig, arrival)
            compare.carry(state, before, arrival)
            chosen()
        view.camera = framing(bounds_of(state), 1.2)
        view.at_home = True
        camera = camera_part(view.camera)
        view.tell(bones=bones_part(state), camera=camera)
        if "camera" in arrival:
            eye, target = arrival["camera"][:3], arrival["camera"][3:]
            session.look(Camera(tuple(eye), tuple(target)))
        session.habits.begin()
        session.bind()

    def _land(self, rig: Rig, arrival: dict[str, Any]) -> None:
        names, state = rig.skeleton.names, self._session.state
        if arrival.get("bone") in names:
            state.joint = names.index(arrival["bone"])
        state.turns = {j: t for j, t in arrival.get("turns", {}).items() if j < len(names)}
        if -1 <= arrival.get("clip", -2) < len(rig.clips):
            state.clip = arrival["clip"]
        state.tour = arrival.get("tour", state.tour)
        if 0 <= arrival.get("vertex", -1) < len(rig.mesh.vertices):
            state.vertex = arrival["vertex"]
        self._told = arrival.get("told", "")
