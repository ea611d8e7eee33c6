"""What contents of layers are made from: the file's weights, computed ones, operators."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array

from ...animation.falloff.rigid_accessories import attach
from ...errors import ParameterError, WeightsError
from ...graph import CutCellGraph
from ...method import Method
from ...rig import Rig
from ...weights.prune import prune
from ..locks import joint_index, lock_joints
from ..selections import Neighbours
from ..symmetry import balanced, find_mirror, mirrored
from .contents import Filled, Locked, Mirrored, Remapped, Smoothed
from .layer import Layer, Mask
from .painted import Painted

Which = NDArray[np.intp] | None
"""Vertices, ascending; None for all."""
Rows = tuple[Which, Any]
SHELL_CELLS = 1.5
"""Lattice cells: shells that are closer are smoothed together, through the body."""


def vertices_of(mask: Mask, component: Callable[[], NDArray[np.integer]]) -> Which:
    """Return the vertices of a mask; None for all."""
    if mask.part is not None:
        label = component()
        return np.flatnonzero(label == label[mask.part])
    return None if mask.vertices is None else mask.vertices.astype(np.intp)


@dataclass(eq=False)
class RigSources:
    """Sources of a rig.

    Parameters
    ----------
    rig : Rig
    method : Method
        Its greatest number of influences holds for layers, too.
    graph : CutCellGraph or None
        Needed by parts, attached ones, and smoothing through the body.
    computed : callable
        Returns the weights, shape (n, j), of a layer with a `Computed` content.
    """

    rig: Rig
    method: Method
    graph: CutCellGraph | None = None
    computed: Callable[[Layer], NDArray[np.float64]] | None = None

    @cached_property
    def priority(self) -> NDArray[np.intp]:
        """The order of joints with the same weight."""
        return np.lexsort(self.rig.skeleton.joints.T)

    def component(self) -> NDArray[np.integer]:
        """Return the connected component of each vertex, shape (n,)."""
        assert self.graph is not None
        return self.graph.mesh.component[self.graph.vertex_node]

    def rows(self, layer: Layer, below: NDArray[np.float64], which: Which) -> Rows:
        """Return which of some vertices a layer's content has weights for, and their rows.

        Shapes: below (n, j), the weights below the layer; returns rows (k, j).
        """
        return getattr(self, f"_{layer.content.kind}")(layer, below, which)

    def _computed(self, layer: Layer, below: NDArray[np.float64], which: Which) -> Rows:
        assert self.computed is not None
        weights = self.computed(layer)
        return which, weights if which is None else weights[which]

    def _file(self, layer: Layer, below: NDArray[np.float64], which: Which) -> Rows:
        weights = self.rig.weights
        if weights is None:
            raise WeightsError(f"{self.rig.name} has no weights in its file")
        rows = weights if which is None else weights[which]
        some = rows.any(axis=1)
        if some.all():
            return which, rows
        return np.flatnonzero(some) if which is None else which[some], rows[some]

    def _filled(self, layer: Layer, below: NDArray[np.float64], which: Which) -> Rows:
        assert isinstance(layer.content, Filled)
        weights, rig = layer.content.weights, self.rig
        columns = [joint_index(rig.skeleton, name) for name in weights]
        which = np.arange(len(below)) if which is None else which
        if rig.allowed is not None:
            for name, column in zip(weights, columns, strict=True):
                bad = np.flatnonzero(~rig.allowed[which, column])
                if weights[name] and len(bad):
                    place = f"vertex {which[bad[0]]}"
                    if layer.mask.part is not None:
                        place = f"the part of vertex {layer.mask.part}"
                    raise ParameterError(f'the file cannot store weight of "{name}" for {place}')
        count, starts = len(which), np.arange(len(which) + 1) * len(columns)
        data, indices = np.tile(list(weights.values()), count), np.tile(columns, count)
        return which, csr_array((data, indices, starts), shape=(count, below.shape[1]))

    def _attached(self, layer: Layer, below: NDArray[np.float64], which: Which) -> Rows:
        assert self.graph is not None
        node, label = self.graph.vertex_node, self.component()
        touching = np.zeros(label.max() + 1, np.bool_)
        touching[label if which is None else label[which]] = True
        if touching[label].all():
            raise ParameterError("every component is to follow where it touches, and none is left")
        first = self.graph.mesh.first
        attached = attach(self.graph, touching, csr_array(below[first]))
        assert which is not None
        rows = attached[node[which]].toarray()
        if self.rig.allowed is not None:
            rows = np.where(self.rig.allowed[which], rows, 0.0)
        total = rows.sum(axis=1, keepdims=True)
        return which, np.divide(rows, total, out=below[which], where=total > 0)

    def _painted(self, layer: Layer, below: NDArray[np.float64], which: Which) -> Rows:
        content = layer.content
        assert isinstance(content, Painted)
        columns = np.array([joint_index(self.rig.skeleton, name) for name in content.joints])
        rows, vertices = content.rows, content.vertices.astype(np.intp)
        shape = len(vertices), below.shape[1]
        rows = csr_array((rows.data, columns[rows.indices], rows.indptr), shape=shape)
        if which is None:
            return vertices, rows
        some = np.isin(vertices, which, assume_unique=True)
        return vertices[some], rows[np.flatnonzero(some)]

    def _smoothed(self, layer: Layer, below: NDArray[np.float64], which: Which) -> Rows:
        content = layer.content
        assert isinstance(content, Smoothed)
        neighbours = self._through if content.through else self._over
        return which, self._pruned(neighbours.smooth(below, content.steps, which), which)

    def _mirrored(self, layer: Layer, below: NDArray[np.float64], which: Which) -> Rows:
        assert isinstance(layer.content, Mirrored)
        points, mirror = self.rig.mesh.vertices, find_mirror(self.rig)
        rows = mirrored(below, mirror, points, layer.content.side, which)
        return which, balanced(self._pruned(rows, which), mirror, which)

    def _locked(self, layer: Layer, below: NDArray[np.float64], which: Which) -> Rows:
        assert isinstance(layer.content, Locked)
        joints, most = list(layer.content.joints), self.method.max_influences
        return which, lock_joints(self.rig, below, joints, most, which)

    def _remapped(self, layer: Layer, below: NDArray[np.float64], which: Which) -> Rows:
        assert isinstance(layer.content, Remapped)
        joints, skeleton = layer.content.joints, self.rig.skeleton
        sources = [joint_index(skeleton, name) for name in joints]
        targets = [joint_index(skeleton, name) for name in joints.values()]
        which = np.arange(len(below)) if which is None else which
        which = which[(below[which][:, sources] > 0).any(axis=1)]
        rows = below[which]
        moved = rows[:, sources]
        rows[:, sources] = 0.0
        np.add.at(rows.T, targets, moved.T)
        if self.rig.allowed is not None:
            can = ~((rows > 0) & ~self.rig.allowed[which]).any(axis=1)
            which, rows = which[can], rows[can]
        return which, rows

    @cached_property
    def _over(self) -> Neighbours:
        return Neighbours.of(self.rig.mesh)

    @cached_property
    def _through(self) -> Neighbours:
        assert self.graph is not None
        lattice = self.graph.lattice
        return Neighbours.of(
            self.rig.mesh, within=SHELL_CELLS * (lattice.size / lattice.resolution)
        )

    def _pruned(self, rows: NDArray[np.float64], which: Which) -> NDArray[np.float64]:
        """Keep the largest weights that the file can store, unless a row would be left empty."""
        allowed = self.rig.allowed
        if allowed is not None:
            storable = np.where(allowed if which is None else allowed[which], rows, 0.0)
            total = storable.sum(axis=1, keepdims=True)
            rows = np.divide(storable, total, out=rows.copy(), where=total > 0)
        few = self.method.max_influences, self.method.threshold
        return prune(csr_array(rows), *few, self.priority).toarray()
