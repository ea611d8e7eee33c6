"""Find what is wrong with the character once it is bound; look at a finding; repair."""

from typing import Any

import numpy as np

from cutcell.diagnosis import Diagnosis, Repaired, diagnose
from cutcell.geodesics import BoneDistances
from cutcell.graph.fingerprint import skeleton_fingerprint
from cutcell.rig import Rig
from cutcell.runtime.progress import Progress
from cutcell_viewers.finding_scene import camera_on

from ..scenes.common import bounds_of
from ..state.check import Repair
from ..state.method import GRAPH, method_of
from .binding import binding_request, resume, swap
from .correct import with_file_parts
from .look import set_camera
from .session import Session


def watch(session: Session) -> None:
    """Keep the diagnosis up to the character and its graph."""
    session.state.param.watch(lambda *events: _begin_anew(session), "rig")
    session.state.param.watch(lambda *events: examine(session), ["rig", "binding", "bare_graph"])
    session.state.param.watch(
        lambda *events: session.tasks.after_a_pause(lambda: examine_export(session), "export"),
        ["panel", "binding"],
    )


def _begin_anew(session: Session) -> None:
    state = session.state
    session.tasks.jobs("diagnosis").cancel()
    session.tasks.jobs("export check").cancel()
    session.binder.is_diagnosed = False
    state.param.update(diagnosis=None, export_diagnosis=None, finding="")
    if state.repair is not None and state.repair.after is not state.rig:
        state.repair = None


def examine(session: Session) -> None:
    """Diagnose the open character, unless its diagnosis is there already."""
    state, binder = session.state, session.binder
    if state.graph is None or not binder.is_for(binding_request(state)):
        return  # the graph of the present choices is not built yet
    if binder.is_diagnosed:
        return
    rig, resolution = state.rig, state.resolution
    binder.is_diagnosed = True
    cached = _reusable(state)

    def work(progress: Progress) -> Diagnosis:
        return diagnose(rig, resolution, distances=cached, progress=progress)

    def done(diagnosis: Diagnosis) -> None:
        state.diagnosis = diagnosis
        if state.panel == "check":
            _show_finding(session)

    session.tasks.jobs("diagnosis").start(work, done, session.fail, lambda stage, fraction: None)


def examine_export(session: Session) -> None:
    """Check the weights that an export contains, while the panel shows the findings."""
    state = session.state
    if (
        state.panel != "check"
        or state.binding is None
        or not session.binder.is_for(binding_request(state))
    ):
        return
    rig, resolution = state.rig.with_weights(state.binding.weights), state.resolution
    last = state.export_diagnosis
    if last is not None and np.array_equal(last.rig.weights, rig.weights):
        return
    distances = _reusable(state)

    def work(progress: Progress) -> Diagnosis:
        return diagnose(rig, resolution, distances=distances, only_weights=True, progress=progress)

    def done(diagnosis: Diagnosis) -> None:
        state.export_diagnosis = diagnosis

    session.tasks.jobs("export check").start(work, done, session.fail, lambda stage, fraction: None)


def _reusable(state: Any) -> BoneDistances | None:
    """Return the binding's distances if a diagnosis of the character would measure the same."""
    names = tuple(name for name in GRAPH if name != "resolution")
    if state.binding is None or method_of(type(state)(), names) != method_of(state, names):
        return None
    distances: BoneDistances = state.binding.distances
    of_rig = skeleton_fingerprint(state.rig.skeleton)
    return distances if of_rig.items() <= distances.fingerprint.items() else None


def look_at(session: Session, code: str) -> None:
    """Mark what a finding names, and go there; an empty code, or the same again, leaves it."""
    state = session.state
    if code == state.finding:
        code = ""
    state.finding = code
    _show_finding(session)


def go_to(session: Session, code: str) -> None:
    """Open the panel that shows a finding and its advice."""
    state = session.state
    state.param.update(panel="check", finding=code)
    _show_finding(session)  # where the check is not done yet, it is looked at then


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
            resume(session)
        else:
            swap(session, after, repair=done, **_corrections(session, before.rig, after))

    session.start(work, show, failed=lambda: resume(session))


def _corrections(session: Session, before: Rig, after: Rig) -> dict[str, Any]:
    """Return corrections that use repaired weights of the file, where it is these that changed."""
    if before.weights is after.weights or session.state.graph is None:
        return {}
    return {"corrections": with_file_parts(session)}


def take_back(session: Session) -> None:
    """Restore the character as it was before all repairs."""
    if session.state.repair is not None:
        swap(session, session.state.repair.before, repair=None)
