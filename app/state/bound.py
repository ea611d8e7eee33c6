"""The current binding and the requested one."""

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from typing import Any

from scipy.sparse import csr_array

from cutcell.editing.corrections import Corrections
from cutcell.geodesics import BoneDistances
from cutcell.graph import CutCellGraph
from cutcell.rig import TriangleMesh

Request = dict[str, Any]
"""The graph's parameters, and the corrections that distances depend on."""


@dataclass(frozen=True, eq=False)
class Bound:
    """The last binding, and its request.

    Parameters
    ----------
    mesh : TriangleMesh
    request : Request
    corrections : Corrections
        All that the weights contain.
    graph : CutCellGraph
    cutoff : float
        How many times as far as the nearest joint distances are known.
    falloffs : dict
        For each falloff that was computed the distances, and the weights of many influences:
        sparse, as most of an (n, j) matrix is zero, and a session has it as long as it lives.
    """

    mesh: TriangleMesh
    request: Request
    corrections: Corrections
    graph: CutCellGraph
    cutoff: float = 0.0
    falloffs: dict[str, tuple[BoneDistances, csr_array]] = field(default_factory=dict)


class Binder:
    """The transitions of a session's binding.

    Attributes
    ----------
    requested : Request
        What is being bound, or was last.
    bound : Bound or None
        What was computed last.
    is_diagnosed : bool
        Whether it is examined already.
    notice : str
        What is shown once it arrives; empty for nothing.
    """

    def __init__(self) -> None:
        self.requested: Request = {}
        self.bound: Bound | None = None
        self.is_diagnosed = False
        self.notice = ""

    def request(
        self, requested: Request, mesh: TriangleMesh, of_graph: Sequence[str]
    ) -> CutCellGraph | None:
        """Begin something else; return the graph of the last binding if it has the same.

        Parameters
        ----------
        requested : Request
        mesh : TriangleMesh
        of_graph : sequence of str
            The parameters that the graph depends on: joints do not matter.
        """
        self.requested = requested
        if self.bound is None or self.bound.mesh is not mesh:
            self.bound = None  # two of them need not be in memory
            return None
        is_same = all(self.bound.request[name] == requested[name] for name in of_graph)
        return self.bound.graph if is_same else None

    def arrived(self, bound: Bound) -> str:
        """Hold what was computed; return the notice that waited for it."""
        self.bound, self.is_diagnosed = bound, False
        notice, self.notice = self.notice, ""
        return notice

    def reweighted(self, corrections: Corrections) -> None:
        """Hold that the weights contain other corrections now."""
        if self.bound is not None:
            self.bound = replace(self.bound, corrections=corrections)

    def withdrawn(self, requested: Request | None = None) -> None:
        """Want something else without binding it: what there is; by default nothing."""
        self.requested = requested or {}

    def is_for(self, request: Request) -> bool:
        """Whether what was computed is for a request."""
        return self.bound is not None and self.bound.request == request
