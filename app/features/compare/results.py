"""Results of the compared methods, one after the other; a failure stops no other method."""

import logging
from dataclasses import dataclass
from typing import Any

from numpy.typing import NDArray

import cutcell
from cutcell.errors import Cancelled, CutcellError
from cutcell.isolated.run import stoppable
from cutcell.rig import Rig
from cutcell.runtime.progress import Progress
from cutcell_lab.baselines import METHODS
from cutcell_lab.baselines.methods import accepted_options
from cutcell_lab.metrics import (
    DeformationError,
    deformation_error,
    unweighted,
    vertex_shares,
    weight_l1,
)
from cutcell_lab.sweeps import bind_setting

from ...derive.derived import Derived
from ...derive.jobs import COMPARING
from ...document.method import effective, method_of
from ...document.session import Session
from ...document.side_by_side import (
    FEWEST_VIEWS,
    MAX_VIEWS,
    NOW,
    SINGLE,
    is_settings,
    listed,
    name_of,
    offered,
    settings,
    single_choices,
)
from ...document.state import State
from ...server.messages import error_text, visible_text
from .lab.results import choices_of

logger = logging.getLogger("cutcell.app")


@dataclass(frozen=True, eq=False)
class Compared:
    """Result of one method for the rig.

    Parameters
    ----------
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
    """

    weights: NDArray | None
    failed: str = ""
    seconds: float | None = None
    l1: float | None = None
    deformation: float | None = None
    unweighted: float | None = None
    errors: DeformationError | None = None


def choose(session: Session, name: str, chosen: bool) -> None:
    """Put a method beside the others, or take it away; two to four stay."""
    state = session.state
    names = [one for one in state.methods if one != name]
    if chosen:
        names = [one for one in listed(state.rig, [*names, name]) if one in {*names, name}]
    if FEWEST_VIEWS <= len(names) <= MAX_VIEWS:
        single = single_choices({one: getattr(state, one) for one in SINGLE}, names)
        state.param.update(methods=names, **single)


def add(session: Session) -> None:
    """Put the page's settings beside the others, with another value of the option to change."""
    state, option = session.state, session.state.added_option
    try:
        changed = choices_of(option, state.added_value) if option else {}
        name = name_of(cutcell.Method(**effective({**method_of(state), **changed})))
        if name in state.methods:
            raise cutcell.ParameterError("these settings are among the methods already")
        choose(session, name, True)
    except CutcellError as error:
        session.fail(error)


def cancel(session: Session) -> None:
    """Stop computing; methods without a result leave the page."""
    state = session.state
    methods = [name for name in state.methods if name in state.compared or name == NOW]
    spare = [name for name in ("artist", "euclidean") if name in offered(state.rig)]
    names = methods + [name for name in spare if name not in methods]
    state.methods = names[: max(len(methods), FEWEST_VIEWS)]


def measured(rig: Rig, name: str, binding: Any, resolution: int, progress: Progress) -> Compared:
    """Bind a rig by a method and measure the result; an expected failure is a result."""
    progress(name, 0.0)
    if name == NOW:
        weights, seconds = binding.weights, binding.seconds
    else:
        try:
            result = _result(rig, name, binding, resolution, progress)
        except CutcellError as error:
            return Compared(None, visible_text(str(error)))
        weights, seconds = result.weights, result.seconds
        if weights is None:
            return Compared(None, visible_text(result.failed), float(sum(seconds.values())))
    progress(name, 0.9)
    share = vertex_shares(rig.mesh)
    total, none = float(sum(seconds.values())), unweighted(weights, share)
    if rig.weights is None:
        return Compared(weights, seconds=total, unweighted=none)
    errors = deformation_error(rig, weights, rig.weights, progress=lambda *_: progress(name, 0.9))
    l1 = weight_l1(weights, rig.weights, share)
    return Compared(weights, "", total, l1, errors.mean, none, errors)


def _result(rig: Rig, name: str, binding: Any, resolution: int, progress: Progress) -> Any:
    """Return the weights of a method or of settings, and their seconds."""
    if is_settings(name):
        return bind_setting(rig, settings(name), binding, lambda *_: progress(name, 0.5))
    method = METHODS[name]
    with stoppable(lambda: progress(name, 0.0)):
        return method(rig, **accepted_options(method, resolution=resolution, progress=progress))


def _inputs(state: State, name: str) -> tuple[Any, ...] | None:
    if state.binding is None:
        return None
    # Other methods do not depend on what the page has computed.
    if is_settings(name):
        return state.rig, name
    return state.rig, name, state.binding if name == NOW else state.resolution


def _compared(rig: Rig, name: str, *more: Any, progress: Progress) -> Compared:
    binding, resolution = more[-2:]
    try:
        return measured(rig, name, binding, resolution, progress)
    except Cancelled:
        raise
    except Exception as error:  # it stops no other method
        logger.error("a method failed", exc_info=error)
        return Compared(None, error_text(error))


RESULTS = (
    Derived(
        "compared",
        _inputs,
        _compared,
        parts=lambda state: state.methods,
        wanted=lambda state, name: state.panel == "compare",
        more=lambda state, name: (state.binding, state.resolution),
        lane="compared",
        slots=lambda state: COMPARING,
        failed=lambda session, name: cancel(session),
    ),
)
