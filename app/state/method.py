"""The parameters of the method, with the defaults of `cutcell.bind`."""

from typing import Any

import cutcell
from cutcell.method import GraphOptions, WeightOptions

GRAPH = ("resolution", *GraphOptions.__annotations__, "leaf")
"""Parameters whose change needs new distances."""

WEIGHTS = tuple(WeightOptions.__annotations__)
"""Parameters whose change needs new weights, but no new distances."""


def default(name: str) -> Any:
    """Return the default of an option of `cutcell.bind`."""
    value = getattr(cutcell.ANIMATION, name)
    return cutcell.PAPER.alpha if name == "alpha" else value


def effective(options: dict[str, Any]) -> dict[str, Any]:
    """Drop options that the falloff does not use, which the core refuses."""
    unused = "refine" if options["falloff"] == "paper" else "alpha"
    return {name: value for name, value in options.items() if name != unused}


def method_of(state: Any, names: tuple[str, ...] = (*GRAPH, *WEIGHTS)) -> dict[str, Any]:
    """Return the parameters that a state holds, by their names."""
    return {name: getattr(state, name) for name in names}
