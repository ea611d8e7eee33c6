"""The features of the page, a folder each, and the packages below them that declare choices.

A package may have these modules, whose names `Feature` lists:

- `choices.py`: a part of the state, and the record of a panel;
- `results.py`: what is computed;
- `scene.py`: the scene of a panel;
- `controls.py`: the controls of a panel;
- `view.py`: handles and other parts of the view, keys, and what else follows the state.
- `overlay.py`: a widget over the canvas.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from importlib import import_module
from importlib.util import find_spec
from typing import TYPE_CHECKING, Any

from cutcell_viewers.description import Description

from ..derive.derived import Derived
from ..document.state import Panel, State

if TYPE_CHECKING:
    from ..document.session import Session

PACKAGES = (
    "editing.binding",
    "features.graph",
    "features.distance",
    "features.weights",
    "editing.correct",
    "editing.brush",
    "editing.select",
    "editing.transfer",
    "features.pose",
    "editing.symmetry",
    "features.compare",
    "features.compare.disagreement",
    "features.compare.lab",
    "features.check",
    "features.flat",
    "features.inspector",
    "features.learn",
    "features.pairs",
)
"""In the order in which panels are offered."""


@dataclass(frozen=True)
class Handle:
    """A point in the view that can be dragged.

    Parameters
    ----------
    at : callable
        Takes the state; returns the point in the scene, shape (3,), or None while there is none.
    move : callable
        Takes the session, where the point is dragged to, and whether it is let go.
    """

    at: Callable[[State], Any]
    move: Callable[[Session, Sequence[float], bool], Any]


@dataclass(frozen=True)
class Feature:
    """What a package gives to the page; each module is imported when it is needed.

    Commands that need no widgets import no controls.

    Parameters
    ----------
    package : str
        Its name in the app.
    """

    package: str

    def _declared(self, module: str, name: str, otherwise: Any = None) -> Any:
        full = f"cutcell_app.{self.package}.{module}"
        return getattr(import_module(full), name, otherwise) if find_spec(full) else otherwise

    @property
    def name(self) -> str:
        """The last name of the package, which names its panel."""
        return self.package.rpartition(".")[2]

    @cached_property
    def choices(self) -> type | None:
        """Class of the parameters that are chosen; `choices.Choices`."""
        choices: type | None = self._declared("choices", "Choices")
        return choices

    @cached_property
    def tools(self) -> frozenset[str]:
        """Names of parameters of tools; see `State`; `choices.TOOLS`."""
        return frozenset(self._declared("choices", "TOOLS", ()))

    @cached_property
    def panel(self) -> Panel | None:
        """The record of its panel, if it has one; `choices.PANEL`."""
        panel: Panel | None = self._declared("choices", "PANEL")
        return panel

    @cached_property
    def results(self) -> tuple[Derived, ...]:
        """What is computed; `results.RESULTS`."""
        return tuple(self._declared("results", "RESULTS", ()))

    @cached_property
    def scene(self) -> Callable[[State], Description]:
        """The scene of its panel, of a state with a character; `scene.scene`."""
        scene: Callable[[State], Description] = self._declared("scene", "scene")
        return scene

    @cached_property
    def controls(self) -> Any:
        """Controls of its panel, a row of a table; `controls.CONTROLS`."""
        return self._declared("controls", "CONTROLS")

    @cached_property
    def overlay(self) -> Callable[[Session], Any] | None:
        """Returns a widget over the canvas for a session; `overlay.overlay`."""
        overlay: Callable[[Session], Any] | None = self._declared("overlay", "overlay")
        return overlay

    @cached_property
    def parts(self) -> Mapping[str, Callable[[State], Any]]:
        """Parts of the view by their names in messages; None for none; `view.PARTS`."""
        return dict(self._declared("view", "PARTS", {}))

    @cached_property
    def handles(self) -> Mapping[str, Handle]:
        """Points that can be dragged, by their names; `view.HANDLES`."""
        return dict(self._declared("view", "HANDLES", {}))

    @cached_property
    def keys(self) -> Mapping[str, Callable[[Session], Any]]:
        """Actions by their names in `frontend/page/keys.js`; `view.KEYS`.

        The open panel's come first, then those of the page.
        """
        return dict(self._declared("view", "KEYS", {}))

    @cached_property
    def watch(self) -> Callable[[Session], Any]:
        """Connects a new session's view and state to what else follows them; `view.watch`."""
        watch: Callable[[Session], Any] = self._declared("view", "watch", lambda session: None)
        return watch


FEATURES: dict[str, Feature] = {one.name: one for one in map(Feature, PACKAGES)}
"""By their names."""


def results() -> tuple[Derived, ...]:
    """Return the results of all features, which the page and its pictures compute."""
    return tuple(result for one in FEATURES.values() for result in one.results)
