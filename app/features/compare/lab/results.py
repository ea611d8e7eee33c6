"""Results of the laboratory: one setting after the other, none stopped by another's failure."""

import logging
from typing import Any

from param.parameterized import batch_call_watchers

import cutcell
from cutcell.errors import Cancelled, CutcellError, ParameterError
from cutcell.rig import Rig
from cutcell.runtime.progress import Progress
from cutcell_lab.baselines.measured_distance import error_points
from cutcell_lab.sweeps import SweepPoint, bind_setting, measure_setting, parsed_values, points_csv

from ....derive.derived import Derived
from ....document.method import default, effective, method_of
from ....document.session import Session
from ....document.state import State
from ....editing.correct.commands import choose_file, uses_file
from ....files.receive import safe_name
from ....files.table_export import ABOUT
from ....looks.character import has_field
from ....looks.measures import CONVERGED, RESOLUTIONS
from ....looks.measures import method_of as distance_method
from ....server.messages import error_text, visible_text
from .choices import MAX_VALUES

logger = logging.getLogger("cutcell.app")


def watch(session: Session) -> None:
    """End a sweep when each value has its result."""
    state = session.state

    def end(*events: Any) -> None:
        if all(text in state.swept for text in state.sweep_texts):
            state.sweeping = False

    state.param.watch(end, "swept")
    state.param.watch(lambda *events: state.param.update(measuring_errors=False), "error_curves")


def start(session: Session) -> None:
    """Compute the chosen sweep, of weights or of distances."""
    state = session.state
    if state.sweep_of == "distance":
        state.measuring_errors = True
    elif not all(text in state.swept for text in state.sweep_texts):
        state.sweeping = True


def stop(session: Session) -> None:
    """Stop computing; the results so far stay."""
    session.state.param.update(sweeping=False, measuring_errors=False)


def choose_option(session: Session, option: str) -> None:
    """Choose the option that is swept, over the values that are offered for it."""
    session.state.param.update(sweep_option=option, sweep_values="", sweeping=False)


def choose_values(session: Session, text: str) -> None:
    """Choose the values of the sweep, separated by commas."""
    state = session.state
    try:
        if text.strip() and len(parsed_values(text)) > MAX_VALUES:
            raise ParameterError(f"a sweep has at most {MAX_VALUES} values")
        state.sweep_values = text.strip()
    except CutcellError as error:
        session.refuse(error, "sweep_values")


def choices_of(option: str, text: str) -> dict[str, Any]:
    """Return the choices of the page for a value; α also chooses the paper's falloff."""
    value, *more = parsed_values(text)
    if more:
        raise ParameterError(f"one value is needed, not {len(more) + 1}")
    falloff = {"falloff": "paper"} if option == "alpha" else {}
    return {option: value, **falloff}


def choose(session: Session, choices: dict[str, Any]) -> None:
    """Show a setting on the page, in one step of undo."""
    state = session.state
    session.history.part()
    try:
        with batch_call_watchers(state):
            state.param.update(**choices)
            if uses_file(state):
                choose_file(session, False)
                state.message = ("info", "The base is Computed now, so that the setting is seen.")
    except ValueError:
        named = ", ".join(f"{name}={value}" for name, value in choices.items())
        session.state.message = ("info", f"The page does not offer {named}.")


def export(session: Session) -> None:
    """Hand the table over as CSV."""
    state, option = session.state, session.state.sweep_option
    stem = safe_name(state.rig.name).rsplit(".", 1)[0]
    if state.sweep_of == "distance":
        lines = ["connectivity,resolution,error,seconds"]
        lines += [
            f"{one.measure},{one.resolution},{one.error},{one.seconds}"
            for one in state.error_curves or ()
        ]
        session.view.offer(f"{stem}-distance.csv", "\r\n".join([*lines, ""]).encode())
        return
    points = [state.swept[text] for text in state.sweep_texts if text in state.swept]
    reference = "file" if state.rig.weights is not None else "computed"
    others = {name: value for name, value in _others(state).items() if name != option}
    text = points_csv(points, option, {**ABOUT, "reference": reference, **others})
    session.view.offer(f"{stem}-{option}.csv", text.encode())


def _others(state: State) -> dict[str, Any]:
    """Return the options that a sweep does not change, as all of its settings have them."""
    option = state.sweep_option
    falloff = {"falloff": "paper"} if option == "alpha" else {}
    options = {**method_of(state), **falloff, option: default(option)}
    return options if option == "falloff" else effective(options)


def _inputs(state: State, *part: str) -> tuple[Any, ...] | None:
    if state.binding is None:
        return None
    return state.rig, state.sweep_option, *part, tuple(_others(state).items())


def _reference_inputs(state: State) -> tuple[Any, ...] | None:
    return None if state.rig is None or state.rig.weights is not None else _inputs(state)


def _reference(rig: Rig, option: str, others: Any, binding: Any, progress: Progress) -> Any:
    return bind_setting(rig, cutcell.Method(**effective(dict(others))), binding, progress).weights


def _point(
    rig: Any, option: str, text: str, others: Any, *more: Any, progress: Progress
) -> SweepPoint:
    binding, reference = more
    value: Any = None
    try:
        choices = choices_of(option, text)
        value = choices[option]
        method = cutcell.Method(**effective({**dict(others), **choices}))
        setting = bind_setting(rig, method, binding, progress)
        target = rig.weights if rig.weights is not None else reference
        return measure_setting(rig, value, setting, target, progress)
    except Cancelled:
        raise
    except CutcellError as error:
        return SweepPoint(value, visible_text(str(error)))
    except Exception as error:  # it stops no other setting
        logger.error("a setting failed", exc_info=error)
        return SweepPoint(value, error_text(error))


def _of_bone(state: State) -> tuple[Any, ...] | None:
    """Return the inputs of errors of distances, without the page's own R and connectivity."""
    if not has_field(state):
        return None
    return state.rig, state.joint, state.leaf, state.winding_threshold, state.orient


def _is_plotted(state: State) -> bool:
    """Return whether a step of the lesson shows the errors."""
    step = state.lesson_step
    is_error = step is not None and step.plot == "error" and state.step in state.answers
    return is_error and state.panel == "distance"


def _error_curves(rig: Rig, joint: int, *more: Any, progress: Progress) -> Any:
    distances, method = more[-2:]
    return error_points(rig, distances, joint, method, RESOLUTIONS, progress)


RESULTS = (
    Derived(
        "sweep_reference",
        _reference_inputs,
        _reference,
        wanted=lambda state: state.sweeping,
        more=lambda state: (state.binding,),
        failed=stop,
    ),
    Derived(
        "swept",
        _inputs,
        _point,
        parts=lambda state: state.sweep_texts,
        wanted=lambda state, text: state.sweeping,
        more=lambda state, text: (state.binding, state.sweep_reference),
        after=("sweep_reference",),
        lane="swept",
        failed=lambda session, text: stop(session),
    ),
    Derived(
        "error_curves",
        _of_bone,
        _error_curves,
        wanted=lambda state: state.measuring_errors or _is_plotted(state),
        more=lambda state: (state.binding.distances, distance_method(state, CONVERGED)),
        failed=stop,
    ),
)
