"""The triangles of glTF primitives, and the weights on their vertices."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from ....errors import FileError, MeshError, WeightsError
from ...weights import NO_WEIGHTS, ReadWeights, summed
from ..constants import TRIANGLE_FAN, TRIANGLE_STRIP, TRIANGLES
from ..container import Document
from .accessors import Accessor, find_accessor, read_accessor

BYTES_PER_CORNER = 24
"""Bytes of a triangle; in a strip or a fan each corner makes one."""
BYTES_PER_SET = 4 * (8 + 8)
"""Bytes of a vertex's joints and weights, as a list of influences."""


@dataclass(frozen=True, eq=False)
class StoredFaces:
    """Triangles that are stored together: those of one primitive."""

    node: int  # that shows it
    mesh: int
    primitive: int
    first_vertex: int  # the primitive's first vertex in the rig
    rows: slice  # the triangles in the rig's mesh
    is_mirrored: bool  # whether they run the other way in the file
    turned: NDArray[np.bool_] | None = None
    """(m,): where they are no longer the file's: which of those that are left were turned round."""


@dataclass(frozen=True, eq=False)
class Primitive:
    """A primitive of a mesh, of which everything that is read is checked."""

    document: Document
    json: dict[str, Any]
    number: int  # in its mesh
    label: str

    @property
    def attributes(self) -> dict[str, Any]:
        """Accessors by name."""
        named = self.json.get("attributes")
        if not isinstance(named, dict):
            raise FileError(f'{self.label}: has no "attributes"')
        return named

    @property
    def draws_triangles(self) -> bool:
        """Whether it is triangles, not points or lines."""
        return self.json.get("mode", TRIANGLES) in (TRIANGLES, TRIANGLE_STRIP, TRIANGLE_FAN)

    @property
    def influence_sets(self) -> list[int]:
        """The n of all JOINTS_n, ascending."""
        sets = [k.removeprefix("JOINTS_") for k in self.attributes if k.startswith("JOINTS_")]
        return sorted(int(n) for n in sets if n.isdecimal())

    def accessor(self, name: str, kind: str) -> Accessor:
        """Return an attribute's accessor."""
        return find_accessor(self.document, self.attributes[name], kind, self.label)

    @property
    def positions(self) -> NDArray[np.float64]:
        """The vertices, shape (n, 3)."""
        if "POSITION" not in self.attributes:
            raise MeshError(f"{self.label} has no POSITION")
        accessor = self.accessor("POSITION", "VEC3")
        if not accessor.is_finite:
            bad = np.flatnonzero(~np.isfinite(accessor.stored).all(axis=1))
            raise MeshError(
                f"{self.label}: vertex {bad[0]} has a coordinate that is not a finite number; "
                f"{len(bad)} of {len(accessor)} are so"
            )
        return np.asarray(accessor.values, np.float64)

    def faces(self) -> NDArray[np.int64]:
        """Return the triangles, shape (m, 3)."""
        corners = self._corners()
        mode = self.json.get("mode", TRIANGLES)
        if mode == TRIANGLES:
            if len(corners) % 3:
                raise MeshError(f"{self.label}: {len(corners)} corners do not make whole triangles")
            return corners.reshape(-1, 3)
        if mode == TRIANGLE_STRIP:
            faces = np.stack([corners[:-2], corners[1:-1], corners[2:]], axis=1)
            faces[1::2, :2] = faces[1::2, 1::-1]
        else:
            middle = np.full(max(len(corners) - 2, 0), corners[0])
            faces = np.stack([corners[1:-1], corners[2:], middle], axis=1)
        a, b, c = faces.T
        return faces[(a != b) & (b != c) & (c != a)]  # strips are joined by flat triangles

    def _corners(self) -> NDArray[np.int64]:
        """Return the vertices in the order in which they are drawn."""
        count = len(self.accessor("POSITION", "VEC3"))
        if "indices" not in self.json:
            self.document.allowance.take(count * BYTES_PER_CORNER, self.label)
            return np.arange(count)
        corners = read_accessor(self.document, self.json["indices"], "SCALAR", self.label)[:, 0]
        if corners.dtype.kind != "u":
            raise FileError(f"{self.label}: its indices are {corners.dtype}, not unsigned integers")
        self.document.allowance.take(len(corners) * BYTES_PER_CORNER, self.label)
        bad = np.flatnonzero(corners >= count)
        if len(bad):
            raise MeshError(
                f"{self.label}: index {corners[bad[0]]} is out of range: it has {count} vertices "
                f"(numbered from 0); {len(bad)} indices are so"
            )
        return corners.astype(np.int64)

    def weights(self, joints: int) -> ReadWeights:
        """Return the weights (n, joints) as `summed` does; the document gets its warnings."""
        if not self.influence_sets:
            return NO_WEIGHTS
        where, share = self._influences(joints)
        self.document.allowance.take_weights(len(where), joints)
        is_used = share != 0  # also true for what is not a number
        rows = np.nonzero(is_used)[0]
        shape = len(where), joints
        read = summed(rows, where[is_used], share[is_used], shape, self.label)
        self.document.warnings += read.warnings
        return read

    def joint_shares(self, joints: int) -> NDArray[np.float64]:
        """Return the sum of the stored weights on each joint of a skin, shape (joints,)."""
        where, share = self._influences(joints)
        is_used = np.isfinite(share) & (share > 0)
        counted = np.minimum(share[is_used], 1.0)  # a sum must not overflow
        return np.bincount(where[is_used], counted, joints).astype(np.float64)

    def _influences(self, joints: int) -> tuple[NDArray[np.int64], NDArray[np.float64]]:
        """Return the joints and the weights of all sets, (n, 4 for each set)."""
        count, user = len(self.accessor("POSITION", "VEC3")), self.label
        wheres, shares = [np.zeros((count, 0), np.int64)], [np.zeros((count, 0))]
        for n in self.influence_sets:
            if f"WEIGHTS_{n}" not in self.attributes:
                raise WeightsError(f"{user} has JOINTS_{n} but no WEIGHTS_{n}")
            where = self.accessor(f"JOINTS_{n}", "VEC4").values
            if where.dtype.kind != "u":
                raise FileError(f"{user}: JOINTS_{n} are {where.dtype}, not unsigned integers")
            share = self.accessor(f"WEIGHTS_{n}", "VEC4").values
            if share.dtype.kind != "f":
                raise FileError(
                    f"{user}: WEIGHTS_{n} are {share.dtype}, neither floats nor normalised"
                )
            self.document.allowance.take(len(where) * BYTES_PER_SET, user)
            if len(where) != count or len(share) != count:
                raise WeightsError(
                    f"{user}: {count} vertices but {len(where)} JOINTS_{n} and {len(share)} "
                    f"WEIGHTS_{n}"
                )
            carrying = np.isfinite(share) & (share > 0)
            bad = np.flatnonzero(((where >= joints) & carrying).any(axis=1))
            if len(bad):
                raise WeightsError(
                    f"{user}: vertex {bad[0]} is weighted to joint {where[bad[0]].max()} in "
                    f"JOINTS_{n}, but its skin has {joints} joints (numbered from 0)"
                )
            wheres.append(where)
            shares.append(share)
        return np.concatenate(wheres, axis=1), np.concatenate(shares, axis=1)


Drawn: TypeAlias = tuple[Primitive, int, slice]
"""A primitive of a mesh whose vertices and faces were put together, its first vertex, its faces."""


def primitives(document: Document, mesh: Any, user: str = "the document") -> list[Primitive]:
    """Return a mesh's primitives; `user` is who refers to it."""
    listed = document.item("meshes", mesh, user).get("primitives")
    label = document.label("meshes", mesh)
    if not isinstance(listed, list) or not all(isinstance(p, dict) for p in listed):
        raise FileError(f'{label}: "primitives" must be a list of objects')
    return [Primitive(document, p, k, f"{label}, primitive {k}") for k, p in enumerate(listed)]


def drawn_primitives(document: Document, mesh: Any, user: str) -> list[Primitive]:
    """Return a mesh's primitives that are triangles."""
    return [one for one in primitives(document, mesh, user) if one.draws_triangles]


def read_triangles(
    document: Document, mesh: Any, user: str
) -> tuple[NDArray, NDArray, list[Drawn]]:
    """Return vertices, faces and triangle primitives of a whole mesh, buffers counted once."""
    document.item("meshes", mesh, user)
    if mesh in document.triangles:
        return document.triangles[mesh]
    vertices: list[NDArray] = [np.zeros((0, 3))]
    faces: list[NDArray] = [np.zeros((0, 3), int)]
    drawn: list[Drawn] = []
    start: dict[Any, int] = {}
    total = triangles = 0
    for primitive in drawn_primitives(document, mesh, user):
        positions, key = primitive.positions, primitive.attributes["POSITION"]
        if key not in start:
            start[key] = total
            total += len(positions)
            vertices.append(positions)
        corners = primitive.faces()
        rows = slice(triangles, triangles := triangles + len(corners))
        drawn.append((primitive, start[key], rows))
        faces.append(corners + start[key])
    document.triangles[mesh] = np.concatenate(vertices), np.concatenate(faces), drawn
    return document.triangles[mesh]
