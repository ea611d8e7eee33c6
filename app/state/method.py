"""The parameters of the method, with the defaults of `cutcell.bind`."""

from typing import Any

import cutcell
from cutcell.method import GraphOptions, WeightOptions

GRAPH = ("resolution", *GraphOptions.__annotations__, "leaf")
"""What distances are measured again for."""

WEIGHTS = tuple(WeightOptions.__annotations__)
"""What changes weights without measuring any distance again."""


def default(name: str) -> Any:
    """Return what `cutcell.bind` takes when it is not told."""
    value = getattr(cutcell.ANIMATION, name)
    return cutcell.PAPER.alpha if name == "alpha" else value


def effective(options: dict[str, Any]) -> dict[str, Any]:
    """Leave out what the falloff does not ask for, which the core refuses: alpha is the paper's."""
    return {n: v for n, v in options.items() if n != "alpha" or options["falloff"] == "paper"}


def method_of(state: Any, names: tuple[str, ...] = (*GRAPH, *WEIGHTS)) -> dict[str, Any]:
    """Return the parameters that a state holds, by their names."""
    return {name: getattr(state, name) for name in names}
