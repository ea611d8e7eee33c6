"""Everything that a person can choose on the page, and what was computed for it.

One object a browser session, made of the choices of each feature. It knows no widget and no layout.
"""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any, cast

from ..derive.memo import Memo
from ..derive.reading import ReadOnlyState
from .common import Common
from .panels import MODULES, PANELS

__all__ = ["PANELS", "State"]

QUICK_MESH = 60_000
QUICK_GRAPH = 400_000
"""Vertices and faces, nodes and edges: what has no more is described in less than a tenth of a
second, so that a page's own thread may do it."""

A_JOINT = 10
"""As many vertices take the time to describe that one joint takes."""


_CHOICES: Any = tuple(module.Choices for module in MODULES.values() if hasattr(module, "Choices"))


class State(*_CHOICES, Common):  # type: ignore[misc]
    """State of the page.

    Attributes
    ----------
    memo : Memo
        Costly steps of what is shown of it.
    """

    def __init__(self, **values: Any) -> None:
        super().__init__(**values)
        self.memo = Memo()

    @property
    def is_panel_usable(self) -> bool:
        """Whether the panel has anything to show of the character: most need a skeleton."""
        return not self.bare or PANELS[self.panel].works_without_skeleton

    @property
    def quick(self) -> bool:
        """Whether the open character is small enough to be described at once."""
        if self.rig is None:
            return True
        if self.cut_across != "off" and PANELS[self.panel].cuts:
            return False  # the face of a cut takes some tenths of a second
        mesh, graph, joints = self.rig.mesh, self.graph, len(self.rig.skeleton.joints)
        mesh_size = len(mesh.vertices) + len(mesh.faces) + A_JOINT * joints
        graph_size = 0 if graph is None else len(graph.nodes) + len(graph.edges)
        return mesh_size <= QUICK_MESH and graph_size <= QUICK_GRAPH

    def changed(self, **changes: Any) -> State:
        """Return the state with other values of some parameters, which can only be read."""
        return cast(State, ReadOnlyState(State, self, changes))

    def snapshot(self) -> State:
        """Return a copy of all values for another thread, which can only be read."""
        values = SimpleNamespace(**self.param.values(), memo=self.memo)
        return cast(State, ReadOnlyState(State, values))
