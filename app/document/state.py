"""State of the page, without the choices that features declare; it knows no widget and no layout.

`features.state.PageState` adds those: one object a browser session.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from types import SimpleNamespace
from typing import TYPE_CHECKING, Any, ClassVar, cast

from ..derive.memo import Memo
from ..derive.reading import ReadOnlyState
from . import edits
from .common import Common

__all__ = ["Panel", "State"]

QUICK_MESH = 60_000
QUICK_GRAPH = 400_000
"""Vertices and faces, nodes and edges: what has no more is described in less than a tenth of a
second, so that a page's own thread may do it."""

A_JOINT = 10
"""As many vertices take the time to describe that one joint takes."""


@dataclass(frozen=True)
class Panel:
    """A panel of the page, registered by the name of its folder; see `features/__init__.py`.

    Parameters
    ----------
    title : str
        One word.
    icon : str
        Content of an SVG of 24 by 24 units; it is drawn as lines, in the text's colour.
    poses : bool
        Whether the character moves here; on all others it rests.
    cuts : bool
        Whether the character can be cut.
    paints : bool
        Whether the brush works here.
    works_without_skeleton : bool
    is_rendered : bool
        Whether `cutcell render` draws it.
    needs_audit : bool
        Whether it is offered for an audit alone.
    """

    title: str
    icon: str
    poses: bool = False
    cuts: bool = False
    paints: bool = False
    works_without_skeleton: bool = False
    is_rendered: bool = True
    needs_audit: bool = False


class State(edits.Choices, Common):
    """State of the page.

    Attributes
    ----------
    panels : dict of Panel
        By the name in the state, in the address and on the command line, in their order.
    tools : frozenset of str
        Parameters of tools, such as the brush: they are no choices, and undo does not change them.
    memo : Memo
        Costly steps of what is shown of the state.
    """

    panels: ClassVar[Mapping[str, Panel]] = {}
    tools: ClassVar[frozenset[str]] = frozenset()

    def __init__(self, **values: Any) -> None:
        super().__init__(**values)
        self.memo = Memo()

    if TYPE_CHECKING:  # the parameters of features

        def __getattr__(self, name: str) -> Any: ...

        def __setattr__(self, name: str, value: Any) -> None: ...

    @property
    def open_panel(self) -> Panel:
        """The record of the panel that is open."""
        return self.panels[self.panel]

    @property
    def is_panel_usable(self) -> bool:
        """Whether the panel has anything to show of the character: most need a skeleton."""
        return not self.bare or self.open_panel.works_without_skeleton

    @property
    def quick(self) -> bool:
        """Whether the open character is small enough to be described at once."""
        if self.rig is None:
            return True
        if self.cut_across != "off" and self.open_panel.cuts:
            return False  # the face of a cut takes some tenths of a second
        mesh, graph, joints = self.rig.mesh, self.graph, len(self.rig.skeleton.joints)
        mesh_size = len(mesh.vertices) + len(mesh.faces) + A_JOINT * joints
        graph_size = 0 if graph is None else len(graph.nodes) + len(graph.edges)
        return mesh_size <= QUICK_MESH and graph_size <= QUICK_GRAPH

    def changed(self, **changes: Any) -> State:
        """Return the state with other values of some parameters, which can only be read."""
        return cast(State, ReadOnlyState(type(self), self, changes))

    def snapshot(self) -> State:
        """Return a copy of all values for another thread, which can only be read."""
        values = {**self.param.values(), "panels": self.panels, "memo": self.memo}
        return cast(State, ReadOnlyState(type(self), SimpleNamespace(**values)))
