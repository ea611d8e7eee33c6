"""Computes what is compared: one method after the other, none stopped by another's failure."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from numpy.typing import NDArray

from cutcell.errors import CutcellError
from cutcell.isolated.run import stoppable
from cutcell.rig import Rig
from cutcell.runtime.progress import Progress
from cutcell_lab.baselines import METHODS
from cutcell_lab.baselines.methods import known_options
from cutcell_lab.metrics import (
    DeformationError,
    deformation_error,
    unweighted,
    vertex_shares,
    weight_l1,
)

from ..jobs.jobs import COMPARING, WAITING
from ..jobs.messages import error_text, visible_text
from ..scenes.compare import found_of
from ..state import State
from ..state.compare import FEWEST_VIEWS, MAX_VIEWS, NOW, offered, standard
from .session import Session


@dataclass(frozen=True, eq=False)
class Compared:
    """Result of one method for the rig.

    Parameters
    ----------
    rig : Rig
    weights : array, shape (n, j), or None
        None where it failed.
    failed : str
        The reason.
    seconds : float
    l1, deformation : float or None
        Against the file's own weights: the paper's weight error, and its squared distance
        in motion in cm²; None where the file has none.
    unweighted : float or None
        Share of the surface's places without weight.
    errors : DeformationError or None
    source
        What it was computed from, to tell whether it is out of date.
    """

    rig: Rig
    weights: NDArray | None
    failed: str = ""
    seconds: float | None = None
    l1: float | None = None
    deformation: float | None = None
    unweighted: float | None = None
    errors: DeformationError | None = None
    source: Any = None


def watch(session: Session) -> None:
    """Compute what is wanted and not there, while the panel is looked at."""
    state = session.state
    state.param.watch(lambda *events: _forget(session), ["rig", "resolution"])
    state.param.watch(lambda *events: find(session), ["panel", "binding", "methods"])


def choose(session: Session, name: str, chosen: bool) -> None:
    """Put a method beside the others, or take it away; two to four stay."""
    state = session.state
    names = [one for one in state.methods if one != name]
    if chosen:
        names = [one for one in offered(state.rig) if one in {*names, name}]
    if FEWEST_VIEWS <= len(names) <= MAX_VIEWS:
        minus = state.minus if state.minus in names else ""
        state.param.update(methods=names, minus=minus)


def next_method(state: State) -> str | None:
    """Return the next method to be computed, or None."""
    for name in state.methods:
        if found_of(state, name) is None:
            return name
    return None


def find(session: Session) -> None:
    """Start computing, unless that runs already."""
    state, jobs = session.state, session.tasks.jobs("compare")
    if state.panel != "compare" or state.binding is None or jobs.running:
        return
    name = next_method(state)
    if name is None:
        state.comparing = ""
        return
    rig, binding, resolution = state.rig, state.binding, state.resolution
    state.param.update(comparing=name, queued=False)

    def work(progress: Progress) -> Compared:
        return measured(rig, name, binding, resolution, progress)

    def done(result: Compared) -> None:
        state.param.update(compared={**state.compared, name: result}, comparing="")
        find(session)

    def failed(error: Exception) -> None:
        session.fail(error)
        done(Compared(rig, None, error_text(error)))

    def report(stage: str, fraction: float) -> None:
        state.queued = stage == WAITING

    jobs.start(work, done, failed, report, COMPARING)


def cancel(session: Session) -> None:
    """Stop what is being computed; it and what waits are taken off the page."""
    state = session.state
    session.tasks.jobs("compare").cancel()
    methods = [name for name in state.methods if name in state.compared or name == NOW]
    spare = [name for name in ("artist", "euclidean") if name in offered(state.rig)]
    names = (methods + [name for name in spare if name not in methods])[
        : max(len(methods), FEWEST_VIEWS)
    ]
    state.param.update(comparing="", methods=names)


def measured(rig: Rig, name: str, binding: Any, resolution: int, progress: Progress) -> Compared:
    """Return what a method makes of a rig; a failure that it knows of is its result."""
    progress(name, 0.0)
    if name == NOW:
        weights, seconds, source = binding.weights, binding.seconds, binding
    else:
        try:
            method = METHODS[name]
            with stoppable(lambda: progress(name, 0.0)):
                options = known_options(method, resolution=resolution, progress=progress)
                result = method(rig, **options)
        except CutcellError as error:
            return Compared(rig, None, visible_text(str(error)))
        if result.weights is None:
            return Compared(
                rig, None, visible_text(result.failed), float(sum(result.seconds.values()))
            )
        weights, seconds, source = result.weights, result.seconds, None
    progress(name, 0.9)
    share = vertex_shares(rig.mesh)
    total, none = float(sum(seconds.values())), unweighted(weights, share)
    if rig.weights is None:
        return Compared(rig, weights, seconds=total, unweighted=none, source=source)
    errors = deformation_error(rig, weights, rig.weights, progress=lambda *_: progress(name, 0.9))
    l1 = weight_l1(weights, rig.weights, share)
    return Compared(rig, weights, "", total, l1, errors.mean, none, errors, source)


def carry(state: State, before: Rig | None, arrival: Mapping[str, Any]) -> None:
    """Set the methods for a new character: those of an address, else those chosen before.

    Parameters
    ----------
    state : State
        With the new character.
    before : Rig or None
        The one that stood there.
    arrival : mapping
        "methods" and "minus", as far as an address says them.
    """
    chosen = [] if state.methods == standard(before) else state.methods
    names = [name for name in arrival.get("methods", chosen) if name in offered(state.rig)]
    if len(names) < FEWEST_VIEWS:
        names = standard(state.rig)
    minus = arrival.get("minus", state.minus)
    state.param.update(methods=names, minus=minus if minus in names else "")


def _forget(session: Session) -> None:
    session.tasks.jobs("compare").cancel()
    session.state.param.update(compared={}, comparing="")
