"""Vertices whose weights are to be changed, and the limits of these weights."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array

from cutcell.editing.locks import joint_index
from cutcell.errors import ParameterError
from cutcell.rig import Rig


@dataclass(frozen=True, eq=False)
class Selected:
    """Selected vertices of a character, and what limits their weights.

    Parameters
    ----------
    rig : Rig
    weights : array or csr_array, shape (n, j)
    vertices : array, shape (v,), int
    locked : sequence of int or str
        Joints whose weights stay.
    max_influences : int, optional
        Joints that a row may have: locked ones, then those that the operation names, then the
        strongest.
    locked_weights : array, shape (n, j), bool, optional
        Further weights that stay, of all vertices.
    """

    rig: Rig
    weights: Any
    vertices: NDArray[np.intp]
    locked: Sequence[int | str] = ()
    max_influences: int | None = None
    locked_weights: NDArray[np.bool_] | None = None

    @cached_property
    def is_locked(self) -> NDArray[np.bool_]:
        """Whether each joint is locked, shape (j,)."""
        locked = np.zeros(len(self.rig.skeleton.names), np.bool_)
        locked[[joint_index(self.rig.skeleton, one) for one in self.locked]] = True
        return locked

    @cached_property
    def stays(self) -> NDArray[np.bool_]:
        """Which weights of the vertices are locked, shape (v, j)."""
        shape = len(self.vertices), len(self.is_locked)
        if self.locked_weights is None:
            return np.broadcast_to(self.is_locked, shape)
        return self.is_locked | self.locked_weights[self.vertices]

    @cached_property
    def rows(self) -> NDArray[np.float64]:
        """Weights of the vertices, shape (v, j)."""
        return rows_at(self.weights, self.vertices)

    @property
    def allowed(self) -> NDArray[np.bool_]:
        """Which joints each vertex may follow, shape (v, j)."""
        allowed = self.rig.allowed
        return np.ones(self.rows.shape, np.bool_) if allowed is None else allowed[self.vertices]

    def takes(self, joint: int) -> NDArray[np.bool_]:
        """Return which vertices can get another weight of a joint, shape (v,)."""
        return self.allowed[:, joint] & ~self.stays[:, joint]

    def joint(self, joint: int | str) -> int:
        """Return the index of a joint whose weight may change, or raise an error."""
        index = joint_index(self.rig.skeleton, joint)
        name = self.rig.skeleton.names[index]
        if self.is_locked[index]:
            raise ParameterError(f'"{name}" is locked; unlock it to change its weight')
        if not self.rig.skeleton.deform[index]:
            raise ParameterError(f'"{name}" carries no weight; let it, to change its weight')
        return index

    def check_unlocked(self, *joints: int | str) -> None:
        """Raise an error if no weight of some joints may change."""
        indices = [self.joint(one) for one in joints]
        if len(self.vertices) and self.stays[:, indices].all():
            names = ", ".join(f'"{self.rig.skeleton.names[one]}"' for one in indices)
            raise ParameterError(f"{names} is locked there; switch off the layer that locks it")

    def finished(
        self, rows: NDArray[np.float64], joints: Sequence[int] = ()
    ) -> NDArray[np.float64]:
        """Return rows that respect the limits; named joints get what they have in `rows` first."""
        before, joints = self.rows, list(joints)
        locked = np.where(self.stays, before, 0.0)
        free = np.where(self.stays | ~self.allowed, 0.0, np.maximum(rows, 0.0))
        if self.max_influences is not None:
            count = self.max_influences - (locked > 0).sum(axis=1)
            many = np.flatnonzero((free > 0).sum(axis=1) > count)
            order = free[many]
            order[:, joints] += order[:, joints] > 0
            rank = np.argsort(np.argsort(-order, axis=1, kind="stable"), axis=1, kind="stable")
            free[many] = np.where(rank < count[many, None], free[many], 0.0)
        rest = np.maximum(1 - locked.sum(axis=1), 0)
        first = np.zeros_like(free)
        first[:, joints] = free[:, joints]
        others, left = free - first, rest - first.sum(axis=1)
        fits = (others.sum(axis=1) > 0) & (left >= 0)
        shared = np.where(fits[:, None], first + _scaled(others, left), _scaled(free, rest))
        return np.where(free.any(axis=1, keepdims=True), locked + shared, before)

    def with_weight(self, joint: int, value: NDArray[np.float64]) -> NDArray[np.float64]:
        """Give a joint wanted weights (v,); the others share the rest as they did before."""
        others = np.where(self.stays, 0.0, self.rows)
        others[:, joint] = 0.0
        rest = others.sum(axis=1)
        room = np.maximum(1 - np.where(self.stays, self.rows, 0.0).sum(axis=1), 0)
        # A vertex that follows no other joint keeps what is subtracted: nobody would take it.
        value = np.where(rest > 0, np.clip(value, 0, room), np.where(value > 0, room, 0))
        rows = _scaled(others, room - value)
        rows[:, joint] = value
        can = self.takes(joint) & ((rest > 0) | (value > 0))
        return np.where(can[:, None], self.finished(rows, [joint]), self.rows)


def rows_at(weights: Any, vertices: NDArray[Any]) -> NDArray[np.float64]:
    """Return the weights of some vertices, (v, j), as an array; those of all may be sparse."""
    rows = weights[vertices]
    return np.asarray(rows.toarray() if isinstance(rows, csr_array) else rows)


def _scaled(rows: NDArray[np.float64], sums: NDArray[np.float64]) -> NDArray[np.float64]:
    """Scale rows to given sums; empty rows stay empty."""
    total = rows.sum(axis=1, keepdims=True)
    return np.divide(rows * sums[:, None], total, out=np.zeros_like(rows), where=total > 0)
