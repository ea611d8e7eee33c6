"""Results while joints are dragged: a quick preview of the weights, and the exact ones."""

from typing import Any

import cutcell
from cutcell.binding import Binding
from cutcell.editing import Edits
from cutcell.rig import Rig
from cutcell.runtime.progress import Progress

from ...derive.derived import Derived
from ...derive.jobs import DESCRIBING
from ...document.state import State
from ..binding.results import bind_as_chosen, layered, wide_options
from ..compute.preview import Preview


def _inputs(state: State) -> tuple[Any, ...] | None:
    if state.moved is None or state.binding is None:
        return None
    return state.binding, *state.moved


def _previewer(binding: Binding, rig: Rig, state: State, progress: Progress) -> Preview:
    few = {"max_influences": state.max_influences, "threshold": state.threshold}
    method = cutcell.ANIMATION.with_options(**{**wide_options(state), **few})
    return Preview(rig, binding, method, state.edits.reach)


def _preview_inputs(state: State) -> tuple[Any, ...] | None:
    inputs = _inputs(state)
    return None if inputs is None or state.previewer is None else (*inputs, state.previewer)


def _preview(
    binding: Any, rig: Rig, edits: Edits, previewer: Preview, recomputed: Any, progress: Progress
) -> Binding:
    return layered(rig, previewer.bind(rig), edits, recomputed)


def _exact_preview(
    binding: Binding, rig: Rig, edits: Edits, state: State, progress: Progress
) -> Binding:
    return bind_as_chosen(state, rig, edits, binding.graph, progress)


RESULTS = (
    Derived(
        "previewer",
        lambda state: None if state.binding is None else (state.binding,),
        _previewer,
        # Vertices at one place may follow different joints: there is no quick preview.
        wanted=lambda state: state.moved is not None and state.rig.allowed is None,
        more=lambda state: (state.rig, state.snapshot()),
        slots=lambda state: DESCRIBING,
    ),
    Derived(
        "preview",
        _preview_inputs,
        _preview,
        more=lambda state: (state.recomputed,),
        slots=lambda state: DESCRIBING,
        keeps=lambda old, new: True,
        patient=True,
    ),
    Derived(
        "exact_preview",
        _inputs,
        _exact_preview,
        more=lambda state: (state.snapshot(),),
        slots=lambda state: DESCRIBING,
        pause=lambda old, new: new[1].allowed is None,
        keeps=lambda old, new: new[1].allowed is not None,
    ),
)
