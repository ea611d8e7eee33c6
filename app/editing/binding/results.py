"""Results of the open character: graph, distances, weights, and how a vertex comes to them.

The graph, the distances and the weights follow each other. Weights are computed once for many
influences a vertex; the number of influences is chosen afterwards.
"""

import time
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

import cutcell
from cutcell.binding import Binding
from cutcell.binding.warnings import warnings_of
from cutcell.editing import Computed, Edits
from cutcell.editing.edited import adjustments_of
from cutcell.graph import CutCellGraph
from cutcell.graph.fingerprint import data_fingerprint
from cutcell.method import joints_needed
from cutcell.rig import Rig
from cutcell.runtime.progress import Progress
from cutcell.weights import keep_strongest
from cutcell.weights.skinning_weights import last_of, weight_steps
from cutcell.weights.warm_up import is_compiled, warm_up

from ...derive.derived import Derived
from ...derive.jobs import DESCRIBING
from ...document.method import GRAPH, WEIGHTS, effective, method_of
from ...document.state import State
from .bound import MOST, Bound, Influences, bind_wide, graph_seconds
from .layered import Recomputed, layered, recompute, recomputed, recomputed_layers
from .recovery import go_back

OF_GRAPH = tuple(name for name in GRAPH if name != "leaf")
"""Choices that the graph depends on."""
QUICK = ("paper",)
"""Falloffs that are computed at once for a small character."""
CACHED = 4
"""Number of falloffs whose weights are remembered."""


def wide_options(state: State) -> dict[str, Any]:
    """Return the options of a binding of which fewer influences can be kept later."""
    wide = {**method_of(state, (*GRAPH, *WEIGHTS)), "max_influences": MOST, "threshold": 0.0}
    return effective(wide)


def falloff_options(state: State) -> dict[str, Any]:
    """Return the options that weights of many influences follow."""
    return effective({name: getattr(state, name) for name in ("falloff", "alpha")})


def _graph_inputs(state: State) -> tuple[Any, ...] | None:
    return None if state.rig is None else (state.rig.mesh, *method_of(state, OF_GRAPH).values())


def _graph(mesh: Any, *options: Any, progress: Progress) -> CutCellGraph:
    if not is_compiled():
        progress("compile", 0.0)
        warm_up()
    began = time.perf_counter()
    chosen = dict(zip(OF_GRAPH, options, strict=True))
    graph = cutcell.build_graph(mesh, progress=progress, **chosen)
    graph_seconds[graph] = time.perf_counter() - began
    return graph


def _bound_inputs(state: State) -> tuple[Any, ...] | None:
    if state.rig is None or state.bare:
        return None
    return (
        _shown_with(state.rig),
        state.built_graph,
        tuple(data_fingerprint(state.rig.skeleton).values()),
        state.leaf,
        state.edits.reach,
        replace(cutcell.ANIMATION, falloff=state.falloff).reach_needed,
        joints_needed(state.falloff, MOST),
    )


def _shown_with(rig: Rig) -> tuple[Any, ...]:
    """Return the parts of a rig that older weights must share to be shown on it."""
    return rig.mesh, rig.skeleton.names, rig.skeleton.parents.tobytes()


def _reaches(old: tuple[Any, ...], new: tuple[Any, ...]) -> bool:
    """Return whether distances are those, and known as far and from as many joints as needed."""
    *before, reach, joints = old
    *now, farther, more = new
    is_enough = joints is None or (more is not None and more <= joints)
    return before == now and reach >= farther and is_enough


def _bound(*inputs: Any, progress: Progress) -> Bound:
    graph, reach, (rig, options, falloff) = inputs[1], inputs[4], inputs[-3:]
    return bind_wide(rig, graph, reach, options, falloff, progress)


def _influences_inputs(state: State) -> tuple[Any, ...] | None:
    return None if state.bound is None else (state.bound, falloff_options(state))


def _influences(
    bound: Bound, options: dict[str, Any], rig: Rig, reach: Computed, progress: Progress
) -> Influences:
    if bound.influences.options == options:
        return bound.influences
    distances = bound.binding.distances
    wide = cutcell.ANIMATION.with_options(**options, max_influences=MOST)
    adjustments = adjustments_of(rig, distances.graph, reach)
    progress("weights", 0.0)
    steps = weight_steps(distances, wide, rig.allowed, adjustments, progress=progress, scaled=False)
    return Influences(options, last_of(steps))


def _recomputed_inputs(state: State, key: str) -> tuple[Any, ...] | None:
    layer = None if state.bound is None else recomputed_layers(state.edits).get(key)
    return None if layer is None else (state.bound, state.edits.reach, wide_options(state), key)


def _binding_inputs(state: State) -> tuple[Any, ...] | None:
    if state.rig is None or state.bare:
        return None
    few = state.max_influences, state.threshold
    shown_with = _shown_with(state.rig)
    recomputed = {key: state.recomputed.get(key) for key in recomputed_layers(state.edits)}
    edits = replace(state.edits, selections={}, poses={})  # what is saved changes no weights
    return shown_with, state.bound, state.influences, *few, edits, recomputed, state.rig


def _binding(
    shown_with: Any,
    bound: Bound,
    influences: Influences,
    max_influences: int,
    threshold: float,
    edits: Edits,
    recomputed: dict[str, Recomputed],
    rig: Rig,
    progress: Progress,
) -> Binding:
    few: dict[str, Any] = {"max_influences": max_influences, "threshold": threshold}
    base = _base(bound, influences, few)
    return layered(rig, base, edits, recomputed, influences.memo)


def _base(bound: Bound, influences: Influences, few: dict[str, Any]) -> Binding:
    """Return the binding below all layers, with few influences."""
    binding = bound.binding

    def make() -> Binding:
        strongest = keep_strongest(binding.distances, influences.weights, **few)
        options = {"leaf": binding.method.leaf, **influences.options, **few}
        return replace(binding, rows=strongest, method=binding.method.with_options(**options))

    base: Binding = influences.memo("base", (bound, *few.values()), make)
    return base


def weights_below(state: State, place: int) -> NDArray[np.float64]:
    """Return the weights (n, j) below the layer at a place, by the newest results."""
    return weights_with(state, replace(state.edits, layers=state.edits.layers[:place]))


def newest_rows(state: State) -> Any:
    """Return the weights (n, j) by the present edits, also before their binding is there.

    They are sparse where they are computed.
    """
    if state.bound is None or state.influences is None:
        return state.rows
    return _layered(state, state.edits).rows


def weights_with(state: State, edits: Edits) -> NDArray[np.float64]:
    """Return the weights (n, j) that other layers give, by the newest results."""
    return _layered(state, edits).weights


def _layered(state: State, edits: Edits) -> Binding:
    few = {"max_influences": state.max_influences, "threshold": state.threshold}
    recomputed = {key: state.recomputed.get(key) for key in recomputed_layers(edits)}
    base = _base(state.bound, state.influences, few)
    return layered(state.rig, base, edits, recomputed, state.influences.memo)


def bind_as_chosen(
    state: State, rig: Rig, edits: Edits, graph: CutCellGraph, progress: Progress
) -> Binding:
    """Return the binding of a rig, other than the open one, by the choices of a state."""
    options = wide_options(state), falloff_options(state)
    bound = bind_wide(rig, graph, edits.reach, *options, progress)
    recomputed = {
        key: recompute(bound, edits.reach, options[0], rig, layer, progress)
        for key, layer in recomputed_layers(edits).items()
    }
    few = state.max_influences, state.threshold
    return _binding(None, bound, bound.influences, *few, edits, recomputed, rig, progress)


def _warnings(
    binding: Binding, quick: bool, rig: Rig, edits: Edits, progress: Progress
) -> tuple[str, ...]:
    return warnings_of(rig, binding, edits)


def _explanation_inputs(state: State) -> tuple[Any, ...] | None:
    if state.binding is None or state.vertex is None or not state.explain:
        return None
    joint = None if state.binding.rows[state.vertex, state.joint] else state.joint
    return state.rig, state.binding, state.vertex, state.edits, joint


def _explanation(
    rig: Rig, binding: Binding, vertex: int, edits: Edits, joint: Any, progress: Progress
) -> Any:
    return cutcell.explain(
        rig,
        vertex,
        joint=joint,
        distances=binding.distances,
        edits=edits,
        progress=progress,
        method=binding.method,
    )


RESULTS = (
    Derived(
        "built_graph",
        _graph_inputs,
        _graph,
        keeps=lambda old, new: old[0] is new[0],
        pause=lambda old, new: old is not None,
        reported=True,
        failed=go_back,
    ),
    Derived(
        "bound",
        _bound_inputs,
        _bound,
        more=lambda state: (state.rig, wide_options(state), falloff_options(state)),
        after=("built_graph",),
        current=_reaches,
        keeps=lambda old, new: old[0] == new[0],
        # It does not wait again after the graph, and not for a falloff.
        pause=lambda old, new: old is not None and old[1] is new[1] and old[:-2] != new[:-2],
        reported=True,
        failed=go_back,
    ),
    Derived(
        "influences",
        _influences_inputs,
        _influences,
        more=lambda state: (state.rig, state.edits.reach),
        after=("bound",),
        keeps=lambda old, new: old[0] is new[0],
        cached=CACHED,
        immediate=lambda state: state.quick and state.falloff in QUICK,
        patient=True,
        reported=True,
        failed=go_back,
    ),
    Derived(
        "recomputed",
        _recomputed_inputs,
        recomputed,
        more=lambda state, key: (state.rig, recomputed_layers(state.edits)[key]),
        parts=lambda state: recomputed_layers(state.edits),
        after=("bound",),
        reported=True,
        failed=lambda session, key: go_back(session),
    ),
    Derived(
        "binding",
        _binding_inputs,
        _binding,
        after=("influences", "recomputed"),
        keeps=lambda old, new: old[0] == new[0],
        immediate=lambda state: state.quick,
        patient=True,
        failed=go_back,
    ),
    Derived(
        "binding_warnings",
        lambda state: None if state.binding is None else (state.binding, state.quick),
        _warnings,
        more=lambda state: (state.rig, state.edits),
        after=("binding",),
        keeps=lambda old, new: old[0].distances is new[0].distances,
        pause=lambda old, new: old is not None and not new[1],  # between strokes
        slots=lambda state: DESCRIBING,
        immediate=lambda state: state.quick,
    ),
    Derived(
        "explanation",
        _explanation_inputs,
        _explanation,
        after=("binding",),
        keeps=lambda old, new: old[:-1] == new[:-1],
    ),
)
"""In the order in which they follow each other."""
