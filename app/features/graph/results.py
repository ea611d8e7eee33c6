"""Result of the panel Graph: a graph that is easy to read."""

from ...derive.derived import Derived
from ...derive.jobs import COMPUTING, DESCRIBING
from ...document.method import READABLE
from ...editing.binding.bound import build_shown

RESULTS = (
    Derived(
        "easy_graph",
        lambda state: state.graph_inputs,
        lambda *inputs, progress: build_shown(inputs, progress),
        wanted=lambda state: state.panel == "graph" or state.bare,
        # A small graph need not wait until weights are computed, or compiled for.
        slots=lambda state: DESCRIBING if state.graph_resolution <= READABLE else COMPUTING,
    ),
)
