"""Compute a bone's whole field, and its distance by other measures, when they are to be seen."""

from typing import Any

from cutcell.runtime.progress import Progress

from ..jobs.jobs import COMPUTING, DESCRIBING
from ..scenes.distance import farthest, field_of, has_field, wants_field
from ..scenes.graph import build_shown
from ..scenes.measured_distance import error_points
from ..scenes.measures import measured_of, measuring, method_of
from ..state.distance import CONVERGED, MEASURES
from ..state.graph import READABLE
from .session import Session

WAVE_SECONDS = 6.0
SHOWN = ["panel", "binding", "joint", "edge_colors", "vertex", "cut_axis", "graph_face"]
"""Choices that decide whether a field is needed."""
BUILT = ["graph_resolution", "resolution", "connectivity", "winding_threshold", "orient"]
"""Choices that the shown graph depends on, besides the mesh."""
BESIDE = [*(f"beside_{name}" for name in MEASURES), "beside_resolution"]


def watch(session: Session) -> None:
    """Keep the field up to what is seen."""
    session.state.param.watch(lambda *events: find_field(session), [*SHOWN, *BESIDE])
    measured = ["panel", "binding", "joint", *BESIDE]
    session.state.param.watch(lambda *events: find_measured(session), measured)
    session.state.param.watch(lambda *events: find_graph(session), [*BUILT, "panel", "rig"])
    session.view.listen("front", lambda message: halt_wave(session, message["front"]))
    session.state.param.watch(
        lambda *events: run_wave(session),
        ["panel", "wave", "animating", "field", "measured", "joint", "rig", *BESIDE],
    )


def find_graph(session: Session) -> None:
    """Build the graph that the panel Graph shows, where it is another one than that of weights."""
    state, jobs = session.state, session.tasks.jobs("shown graph")
    inputs = state.graph_inputs
    if (state.panel != "graph" and not state.bare) or not inputs or state.shown_graph is not None:
        return

    def done(graph: Any) -> None:
        state.easy_graph = (inputs, graph)

    def report(stage: str, fraction: float) -> None:
        """Report nothing: it takes a moment."""

    # A small graph need not wait until weights are computed, or compiled for.
    slots = DESCRIBING if state.graph_resolution <= READABLE else COMPUTING
    jobs.start(lambda progress: build_shown(inputs, progress), done, session.fail, report, slots)


def halt_wave(session: Session, front: float | None) -> None:
    """Take over where the wave halted in the browser, as a part of the greatest distance."""
    session.state.front = min(max(front or 0.0, 0.0), 1.0)


def run_wave(session: Session) -> None:
    """Play or pause the wavefront in the browser; sent only when it changed."""
    state = session.state
    end = farthest(state)
    runs = state.panel == "distance" and state.wave and state.animating and end is not None
    animation = {"end": end, "seconds": WAVE_SECONDS} if runs else None
    if session.view.last_sent("animation") != animation:
        session.view.send(animation=animation)


def find_field(session: Session) -> None:
    """Compute the chosen bone's distance at every node, where it is wanted and not there."""
    state = session.state
    joint = state.joint
    if not wants_field(state) or field_of(state) is not None:
        return
    distances = state.binding.distances

    def work(progress: Progress) -> Any:
        return distances.field(joint)

    def done(field: Any) -> None:
        state.field = (distances, joint, field)

    session.tasks.jobs("field").start(work, done, session.fail, lambda stage, fraction: None)


def find_errors(session: Session) -> None:
    """Measure the errors of the chosen bone's distances over the resolution."""
    state = session.state
    rig, distances, joint = state.rig, state.binding.distances, state.joint
    method = method_of(state, CONVERGED)
    state.measuring_errors = True

    def done(points: Any) -> None:
        state.param.update(error_curves=(distances, joint, points), measuring_errors=False)

    def failed(error: Exception) -> None:
        state.measuring_errors = False
        session.fail(error)

    session.tasks.jobs("error curves").start(
        lambda progress: error_points(rig, distances, joint, method, progress),
        done,
        failed,
        lambda stage, fraction: None,
    )


def find_measured(session: Session) -> None:
    """Compute the next missing measure of those side by side, unless that runs already."""
    state, jobs = session.state, session.tasks.jobs("measures")
    if state.panel != "distance" or not has_field(state) or jobs.running:
        return
    name = next((one for one in state.measures if measured_of(state, one) is None), None)
    if name is None:
        return
    measure = measuring(state, name)
    state.measuring = name

    def done(result: Any) -> None:
        state.param.update(measured={**state.measured, name: result}, measuring="")
        find_measured(session)

    def failed(error: Exception) -> None:
        state.param.update(measuring="", **{f"beside_{name}": False})
        session.fail(error)
        find_measured(session)

    jobs.start(lambda progress: measure(), done, failed, lambda stage, fraction: None)
