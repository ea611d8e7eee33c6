"""Findings of the open character and of its export; look at a finding; repair."""

from collections.abc import Callable, Collection
from typing import Any

from cutcell.diagnosis import Diagnosis, diagnose
from cutcell.editing import Layer, Mask
from cutcell.errors import ParameterError
from cutcell.geodesics import BoneDistances
from cutcell.graph.fingerprint import data_fingerprint
from cutcell.rig import Rig
from cutcell.runtime.progress import Progress
from cutcell_viewers.finding_scene import camera_on

from ...derive.derived import Derived
from ...derive.jobs import DESCRIBING
from ...derive.tasks import Task
from ...document.document import Repair, put
from ...document.edits import repaired, uses_weights
from ...document.framing import bounds_of
from ...document.look import set_camera
from ...document.method import GRAPH, default, method_of
from ...document.session import Session
from ...document.state import State
from ...editing.compute.stack import put_layer, with_base
from ...editing.correct.commands import correct
from .choices import EXPORT, exchange


def watch(session: Session) -> None:
    """Discard results of another character, and show the finding of an address."""
    follow = session.state.param.watch
    follow(lambda *events: session.state.param.update(finding=""), "rig")
    follow(lambda *events: _show_finding(session), "finding", onlychanged=False)
    follow(lambda *events: _arrived(session, ""), "diagnosis")
    follow(lambda *events: session.state.param.update(tried=None),
           ["rig", "edits", "finding", "panel"])  # fmt: skip
    follow(lambda *events: _arrived(session, EXPORT), "export_diagnosis")


def _arrived(session: Session, prefix: str) -> None:
    """Look at the finding of an address or a link once the diagnosis that has it is there."""
    state = session.state
    is_of_export = state.finding.startswith(EXPORT)
    if state.panel == "check" and is_of_export == (prefix == EXPORT):
        _show_finding(session)


def _inputs(state: State) -> tuple[Any, ...] | None:
    return None if state.graph is None else (state.rig, state.resolution)


def _diagnosis(rig: Rig, resolution: int, distances: Any, progress: Progress) -> Diagnosis:
    return diagnose(rig, resolution, distances=distances, progress=progress)


def _export_inputs(state: State) -> tuple[Any, ...] | None:
    return None if state.binding is None else (state.rig, state.resolution, state.binding)


def _export_diagnosis(
    rig: Rig, resolution: int, binding: Any, distances: Any, progress: Progress
) -> Diagnosis:
    """Check the weights that an export contains."""
    rig = rig.with_weights(binding.weights)
    return diagnose(rig, resolution, distances=distances, only_weights=True, progress=progress)


def _reusable(state: State) -> BoneDistances | None:
    """Return the binding's distances if a diagnosis of the character would measure the same."""
    names = tuple(name for name in GRAPH if name != "resolution")
    if state.binding is None or method_of(state, names) != {name: default(name) for name in names}:
        return None
    distances: BoneDistances = state.binding.distances
    of_rig = data_fingerprint(state.rig.skeleton)
    return distances if of_rig.items() <= distances.fingerprint.items() else None


def look_at(session: Session, code: str) -> None:
    """Mark the elements of a finding and aim the camera; the same code again leaves it."""
    state = session.state
    if code == state.finding:
        code = ""
    state.finding = code


def _show_finding(session: Session) -> None:
    """Look at what the finding names that is looked at."""
    state = session.state
    if state.selected_finding is not None:
        camera = camera_on(state.rig, state.selected_finding, bounds_of(state), session.view.aspect)
        if camera is not None:
            set_camera(session, camera)


class Repairing(Task):
    """Repairs some findings of the open character; edits that are made meanwhile stay."""

    name, title, slots = "repair", "a repair", DESCRIBING

    def __init__(self, session: Session, codes: Collection[str]) -> None:
        self._state, self._codes = session.state, codes
        self._own: Rig = session.state.own

    def begin(self) -> Callable[[Progress], Repair]:
        """Return what repairs; findings of before another repair are found again."""
        state = self._state
        if state.own is not self._own:
            raise ParameterError("another character was opened; repair the finding there")
        own, earlier, rig, resolution = state.own, state.repair, state.rig, state.resolution
        checked = state.diagnosis

        def compute(progress: Progress) -> Repair:
            progress("repairing", 0.0)
            diagnosis = checked or diagnose(rig, resolution, progress=progress)
            return repaired(own, earlier, diagnosis, self._codes)

        return compute

    def finish(self, result: Repair) -> None:
        """Enter the repair into the document, and use the file's weights where it mends them."""
        state = self._state
        values: dict[str, Any] = {"repair": result}
        if result.after is not (state.own if state.repair is None else state.repair.after):
            values |= {"vertex": None, "message": None}
        if state.graph is not None and uses_weights(state.repair, result, state.own):
            values["edits"] = with_base(state.edits, from_file=True)
        put(state, **values)


def repair(session: Session, codes: Collection[str]) -> None:
    """Repair some findings, and bind what comes of it."""
    session.tasks.add(Repairing(session, codes))


def exchange_joints(session: Session) -> None:
    """Put a layer that exchanges the weights of the chosen finding's joints where it says."""
    state, finding = session.state, session.state.selected_finding
    if finding is None or not finding.exchanged:
        return
    edits = state.edits
    if not state.finding.startswith(EXPORT):  # it is about the file's weights
        edits = with_base(edits, from_file=True)
    content, mask = exchange(finding, state.rig.skeleton.names), Mask(vertices=finding.vertices)
    edits, place = put_layer(edits, Layer(content, mask, f"Mended: {finding.title}"))
    session.history.part()
    correct(session, edits)
    if state.edits is edits:
        state.layer = place


def take_back(session: Session) -> None:
    """Restore the character as it was before all repairs."""
    put(session.state, repair=None, vertex=None, message=None)


RESULTS = (
    Derived(
        "diagnosis", _inputs, _diagnosis, more=lambda state: (_reusable(state),), after=("binding",)
    ),
    Derived(
        "export_diagnosis",
        _export_inputs,
        _export_diagnosis,
        wanted=lambda state: state.panel == "check",
        more=lambda state: (_reusable(state),),
        after=("binding",),
        pause=lambda old, new: True,
        keeps=lambda old, new: old[0] is new[0],
    ),
)
