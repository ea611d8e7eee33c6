"""Weights of single vertices: the content of layers that are painted."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.sparse import csr_array, issparse, vstack

from ...checks import assign
from ...errors import ParameterError
from ...rig.checks import frozen
from .contents import SUM_TOLERANCE, Content, Rename
from .packing import ByValue, ascending, joint_names, packed, packed_rows, unpacked_rows


@dataclass(frozen=True, eq=False)
class Painted(ByValue, Content):
    """Weights of single vertices.

    Parameters
    ----------
    vertices : array, shape (k,), int32
        Ascending.
    joints : sequence of str
    rows : array or csr_array, shape (k, len(joints))
        Rows are scaled to sum to one.
    """

    vertices: NDArray[np.int32]
    joints: Sequence[str]
    rows: csr_array

    kind = "painted"
    title = "Painted"
    by_joint = ("joints",)

    def __init__(self, vertices: ArrayLike, joints: Sequence[str], rows: Any) -> None:
        which, names = ascending("vertices", vertices), joint_names("joints", joints)
        if len(names) != len(joints):
            raise ParameterError("joints must be named once each")
        assign(self, vertices=which, joints=names, rows=_checked_rows(rows, which, len(names)))

    def to_data(self) -> dict[str, Any]:
        rows = packed_rows(self.rows)
        return {"vertices": packed(self.vertices), "joints": list(self.joints), "rows": rows}

    @classmethod
    def from_data(cls, vertices: Any, joints: Any, rows: Any) -> Painted:
        """Read what `to_data` returns; rows may be a list of lists, too."""
        if isinstance(rows, Mapping):
            rows = unpacked_rows(rows, len(joint_names("joints", joints)))
        return cls(vertices, joints, rows)

    def renamed(self, now: Rename) -> Content | None:
        new = [now(joint) for joint in self.joints]
        names = tuple(dict.fromkeys(name for name in new if name is not None))
        rows = self._in_columns(new, names)
        some = np.flatnonzero(rows.sum(axis=1) > 0)
        return Painted(self.vertices[some], names, rows[some]) if len(some) else None

    def without(self, vertices: ArrayLike) -> Painted | None:
        """Return it without some vertices; None if none is left."""
        rest = np.flatnonzero(~np.isin(self.vertices, vertices))
        if len(rest) == len(self.vertices):
            return self
        return Painted(self.vertices[rest], self.joints, self.rows[rest]) if len(rest) else None

    def merged(self, above: Painted) -> Painted:
        """Return it with the rows of another one in place of its own."""
        names = tuple(dict.fromkeys((*self.joints, *above.joints)))
        rest = np.flatnonzero(~np.isin(self.vertices, above.vertices))
        vertices = np.concatenate([self.vertices[rest], above.vertices])
        parts = [one._in_columns(one.joints, names) for one in (self, above)]
        order = np.argsort(vertices, kind="stable")
        rows = csr_array(vstack([parts[0][rest], parts[1]], format="csr"))
        return Painted(vertices[order], names, rows[order])

    def differing(self, other: Painted) -> NDArray[np.int32]:
        """Return the vertices, ascending, whose rows differ from those of another one."""
        names = tuple(dict.fromkeys((*self.joints, *other.joints)))
        both, at, at_other = np.intersect1d(
            self.vertices, other.vertices, assume_unique=True, return_indices=True
        )
        rows = self._in_columns(self.joints, names)[at]
        changed = rows != other._in_columns(other.joints, names)[at_other]
        single = np.setxor1d(self.vertices, other.vertices, assume_unique=True)
        return np.union1d(both[np.diff(changed.tocsr().indptr) > 0], single)

    def _in_columns(self, joints: Sequence[str | None], names: Sequence[str]) -> csr_array:
        """Return the rows with columns for other names; joints is None for those left out."""
        column = {name: k for k, name in enumerate(names)}
        pairs = [(k, column[name]) for k, name in enumerate(joints) if name is not None]
        where = tuple(np.array(pairs, int).reshape(-1, 2).T)
        return self.rows @ csr_array((np.ones(len(pairs)), where), (len(joints), len(names)))


def _checked_rows(rows: Any, vertices: NDArray[np.int32], joints: int) -> csr_array:
    """Return rows that sum to one."""
    try:
        matrix = csr_array(rows if issparse(rows) else np.asarray(rows, np.float64))
    except (TypeError, ValueError):
        raise ParameterError(
            f"rows must be an array of shape {len(vertices), joints}: vertices and joints"
        ) from None
    if matrix.shape != (len(vertices), joints):
        raise ParameterError(
            f"rows must be of shape {len(vertices), joints}, vertices and joints, not "
            f"{matrix.shape}"
        )
    if not matrix.has_canonical_format or not matrix.data.all():
        matrix = matrix.copy()
        matrix.sum_duplicates()
        matrix.eliminate_zeros()
    bad = np.flatnonzero(~((matrix.data >= 0) & (matrix.data <= 1e9)))
    if len(bad):
        row = int(np.searchsorted(matrix.indptr, bad[0], "right")) - 1
        raise ParameterError(f"the weights of vertex {vertices[row]} must be 0 to 1")
    total = np.asarray(matrix.sum(axis=1))
    if not (total > 0).all():
        row = int((total > 0).argmin())
        raise ParameterError(
            f"vertex {vertices[row]} needs a weight above 0 for at least one joint"
        )
    if (np.abs(total - 1) > SUM_TOLERANCE).any():
        whole = np.where(np.abs(total - 1) > SUM_TOLERANCE, total, 1.0)
        data = matrix.data / np.repeat(whole, np.diff(matrix.indptr))
        matrix = csr_array((data, matrix.indices, matrix.indptr), matrix.shape)
    for array in (matrix.data, matrix.indices, matrix.indptr):
        frozen(array)
    return matrix
