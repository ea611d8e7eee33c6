"""Findings of the open character and of its export; look at a finding; repair."""

from typing import Any

from cutcell.diagnosis import Diagnosis, Repaired, diagnose
from cutcell.geodesics import BoneDistances
from cutcell.graph.fingerprint import data_fingerprint
from cutcell.rig import Rig
from cutcell.runtime.progress import Progress
from cutcell_viewers.finding_scene import camera_on

from ...derive.derived import Derived
from ...derive.jobs import DESCRIBING
from ...document.framing import bounds_of
from ...document.look import set_camera
from ...document.method import GRAPH, method_of
from ...document.session import Session
from ...document.state import State
from ...editing.compute.stack import with_base
from ...editing.correct.commands import swap
from .choices import EXPORT, Repair


def watch(session: Session) -> None:
    """Discard results of another character, and show the finding of an address."""
    follow = session.state.param.watch
    follow(lambda *events: _begin_anew(session), "rig")
    follow(lambda *events: _show_finding(session), "finding", onlychanged=False)
    follow(lambda *events: _arrived(session, ""), "diagnosis")
    follow(lambda *events: session.state.param.update(tried=None),
           ["rig", "edits", "finding", "panel"])  # fmt: skip
    follow(lambda *events: _arrived(session, EXPORT), "export_diagnosis")


def _begin_anew(session: Session) -> None:
    state = session.state
    state.finding = ""
    if state.repair is not None and state.repair.after is not state.rig:
        state.repair = None


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
    if state.binding is None or method_of(type(state)(), names) != method_of(state, names):
        return None
    distances: BoneDistances = state.binding.distances
    of_rig = data_fingerprint(state.rig.skeleton)
    return distances if of_rig.items() <= distances.fingerprint.items() else None


def look_at(session: Session, code: str) -> None:
    """Mark what a finding names, and go there; an empty code, or the same again, leaves it."""
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


def repair(session: Session, codes: list[str]) -> None:
    """Repair some findings, and bind what comes of it."""
    state, before = session.state, session.state.diagnosis

    def work(progress: Progress) -> Repaired:
        progress("repairing", 0.0)
        return before.repaired(codes)

    def show(repaired: Repaired) -> None:
        first, earlier = before, ()
        if state.repair is not None:
            first, earlier = state.repair, state.repair.done
        original = first.rig if isinstance(first, Diagnosis) else first.before
        in_vain = frozenset(finding.code for finding in repaired.in_vain)
        if not repaired.repaired:  # nothing changed, and what was computed stays
            if isinstance(first, Repair):
                in_vain |= first.in_vain
            after = state.rig
        else:
            after = repaired.rig
        done = Repair(original, after, first.counts, (*earlier, *repaired.done), in_vain)
        if after is state.rig:
            state.repair = done
        else:
            swap(session, after, repair=done, **_edits(session, before.rig, after))

    session.work.start("character", work, show, slots=DESCRIBING)


def _edits(session: Session, before: Rig, after: Rig) -> dict[str, Any]:
    """Return edits that use repaired weights of the file, where it is these that changed."""
    if before.weights is after.weights or session.state.graph is None:
        return {}
    return {"edits": with_base(session.state.edits, from_file=True)}


def take_back(session: Session) -> None:
    """Restore the character as it was before all repairs."""
    if session.state.repair is not None:
        swap(session, session.state.repair.before, repair=None)


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
