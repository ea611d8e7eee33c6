"""The features of the page, a folder each, and the packages below them that declare choices.

A package may have these modules:

- `choices.py`: the class `Choices`, a part of the state, and for a panel its record `PANEL`;
- `results.py`: `RESULTS`, and `watch(session)`;
- `scene.py`: `scene(state, memo)` of a panel;
- `controls.py`: `CONTROLS` of a panel.
"""

from importlib import import_module
from importlib.util import find_spec
from typing import Any

from ..derive.derived import Derived

PACKAGES = (
    "editing.binding",
    "features.graph",
    "features.distance",
    "features.weights",
    "editing.correct",
    "editing.brush",
    "editing.select",
    "features.pose",
    "editing.symmetry",
    "features.compare",
    "features.compare.disagreement",
    "features.compare.lab",
    "features.check",
    "features.learn",
    "features.flat",
    "features.pairs",
)
"""In the order in which panels are offered. Results follow those of packages before them."""


def modules(kind: str) -> dict[str, Any]:
    """Return the modules of a kind, for example "results", by the last name of their package."""
    names = {name.rpartition(".")[2]: f"cutcell_app.{name}.{kind}" for name in PACKAGES}
    return {key: import_module(name) for key, name in names.items() if find_spec(name)}


def results() -> tuple[Derived, ...]:
    """Return the results of all packages, which the page and its pictures compute."""
    return tuple(one for module in modules("results").values() for one in module.RESULTS)
