"""The triangles of glTF primitives, and the weights on their vertices."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from ....errors import FileError, MeshError, WeightsError
from ...weights import NO_WEIGHTS, ReadWeights, summed
from ..constants import TRIANGLE_FAN, TRIANGLE_STRIP, TRIANGLES
from ..container import Document
from .accessors import read_accessor

BYTES_PER_CORNER = 24
"""Bytes of a triangle; in a strip or a fan each corner makes one."""
BYTES_PER_SET = 4 * (8 + 8)
"""Bytes of a vertex's joints and weights, as a list of influences."""
DRAWS_TRIANGLES = (TRIANGLES, TRIANGLE_STRIP, TRIANGLE_FAN)
Drawn: TypeAlias = tuple[dict[str, Any], int, slice]
"""A primitive of a mesh whose vertices and faces were put together, its first vertex, its faces."""


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


def primitives(document: Document, mesh: Any, user: str) -> list[dict[str, Any]]:
    """Return a mesh's primitives."""
    listed = document.item("meshes", mesh, user).get("primitives")
    if not isinstance(listed, list) or not all(isinstance(p, dict) for p in listed):
        raise FileError(f'{document.label("meshes", mesh)}: "primitives" must be a list of objects')
    return listed


def attributes(primitive: dict[str, Any], user: str) -> dict[str, Any]:
    """Return a primitive's attributes."""
    named = primitive.get("attributes")
    if not isinstance(named, dict):
        raise FileError(f'{user}: has no "attributes"')
    return named


def draws_triangles(primitive: dict[str, Any]) -> bool:
    """Return whether a primitive is triangles, not points or lines."""
    return primitive.get("mode", TRIANGLES) in DRAWS_TRIANGLES


def drawn_primitives(
    document: Document, mesh: int, user: str
) -> Iterator[tuple[int, str, dict[str, Any]]]:
    """Yield the number and the label of each primitive that is triangles, and it."""
    for k, primitive in enumerate(primitives(document, mesh, user)):
        if draws_triangles(primitive):
            yield k, f"{document.label('meshes', mesh)}, primitive {k}", primitive


def read_positions(document: Document, primitive: dict[str, Any], user: str) -> NDArray:
    """Return the vertices, shape (n, 3), float64."""
    named = attributes(primitive, user)
    if "POSITION" not in named:
        raise MeshError(f"{user} has no POSITION")
    index = named["POSITION"]
    positions = np.asarray(read_accessor(document, index, "VEC3", user), np.float64)
    if index in document.finite:  # many primitives may share it
        return positions
    bad = np.flatnonzero(~np.isfinite(positions).all(axis=1))
    if len(bad):
        raise MeshError(
            f"{user}: vertex {bad[0]} has a coordinate that is not a finite number; "
            f"{len(bad)} of {len(positions)} are so"
        )
    document.finite.add(index)
    return positions


def read_faces(document: Document, primitive: dict[str, Any], count: int, user: str) -> NDArray:
    """Return the triangles, shape (m, 3), int64, of `count` vertices."""
    if "indices" in primitive:
        corners = read_accessor(document, primitive["indices"], "SCALAR", user)[:, 0]
        if corners.dtype.kind != "u":
            raise FileError(f"{user}: its indices are {corners.dtype}, not unsigned integers")
        document.allowance.take(len(corners) * BYTES_PER_CORNER, user)
        corners = corners.astype(np.int64)
        bad = np.flatnonzero(corners >= count)
        if len(bad):
            raise MeshError(
                f"{user}: index {corners[bad[0]]} is out of range: it has {count} vertices "
                f"(numbered from 0); {len(bad)} indices are so"
            )
    else:
        document.allowance.take(count * BYTES_PER_CORNER, user)
        corners = np.arange(count)
    mode = primitive.get("mode", TRIANGLES)
    if mode == TRIANGLES:
        if len(corners) % 3:
            raise MeshError(f"{user}: {len(corners)} corners do not make whole triangles")
        return corners.reshape(-1, 3)
    if mode == TRIANGLE_STRIP:
        faces = np.stack([corners[:-2], corners[1:-1], corners[2:]], axis=1)
        faces[1::2, :2] = faces[1::2, 1::-1]
    else:
        middle = np.full(max(len(corners) - 2, 0), corners[0])
        faces = np.stack([corners[1:-1], corners[2:], middle], axis=1)
    a, b, c = faces.T
    return faces[(a != b) & (b != c) & (c != a)]  # strips are joined by flat triangles


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
    for _, name, primitive in drawn_primitives(document, mesh, user):
        positions = read_positions(document, primitive, name)
        key = primitive["attributes"]["POSITION"]
        if key not in start:
            start[key] = total
            total += len(positions)
            vertices.append(positions)
        corners = read_faces(document, primitive, len(positions), name)
        rows = slice(triangles, triangles := triangles + len(corners))
        drawn.append((primitive, start[key], rows))
        faces.append(corners + start[key])
    document.triangles[mesh] = np.concatenate(vertices), np.concatenate(faces), drawn
    return document.triangles[mesh]


def influence_sets(named: dict[str, Any]) -> list[int]:
    """Return the n of all JOINTS_n, ascending."""
    sets = [k.removeprefix("JOINTS_") for k in named if k.startswith("JOINTS_")]
    return sorted(int(n) for n in sets if n.isdecimal())


def read_weights(
    document: Document, primitive: dict[str, Any], count: int, joints: int, user: str
) -> ReadWeights:
    """Return the weights (count, joints) as `summed` does; the document gets its warnings."""
    named = attributes(primitive, user)
    sets = influence_sets(named)
    if not sets:
        return NO_WEIGHTS
    joint_sets, share_sets = [], []
    for n in sets:
        where, share = _influences(document, named, n, user)
        document.allowance.take(len(where) * BYTES_PER_SET, user)
        if len(where) != count or len(share) != count:
            raise WeightsError(
                f"{user}: {count} vertices but {len(where)} JOINTS_{n} and {len(share)} WEIGHTS_{n}"
            )
        _check_influences(where, share, joints, n, user)
        joint_sets.append(where)
        share_sets.append(share)
    document.allowance.take_weights(count, joints)
    where, share = np.concatenate(joint_sets, axis=1), np.concatenate(share_sets, axis=1)
    is_used = share != 0  # also true for what is not a number
    rows = np.nonzero(is_used)[0]
    read = summed(rows, where[is_used], share[is_used], (count, joints), user)
    document.warnings += read.warnings
    return read


def joint_shares(document: Document, primitive: dict[str, Any], joints: int, user: str) -> NDArray:
    """Return the sum of the stored weights on each joint of a skin, shape (joints,)."""
    named = attributes(primitive, user)
    shares = np.zeros(joints)
    for n in influence_sets(named):
        where, share = _influences(document, named, n, user)
        if where.shape != share.shape:
            continue  # refused when the weights are read
        _check_influences(where, share, joints, n, user)
        is_used = np.isfinite(share) & (share > 0)
        counted = np.minimum(share[is_used], 1.0)  # a sum must not overflow
        shares += np.bincount(where[is_used].astype(np.int64), counted, joints)
    return shares


def _influences(
    document: Document, named: dict[str, Any], n: int, user: str
) -> tuple[NDArray, NDArray]:
    if f"WEIGHTS_{n}" not in named:
        raise WeightsError(f"{user} has JOINTS_{n} but no WEIGHTS_{n}")
    where = read_accessor(document, named[f"JOINTS_{n}"], "VEC4", user)
    if where.dtype.kind != "u":
        raise FileError(f"{user}: JOINTS_{n} are {where.dtype}, not unsigned integers")
    share = read_accessor(document, named[f"WEIGHTS_{n}"], "VEC4", user)
    if share.dtype.kind != "f":
        raise FileError(f"{user}: WEIGHTS_{n} are {share.dtype}, neither floats nor normalised")
    return where, share


def _check_influences(where: NDArray, share: NDArray, joints: int, n: int, user: str) -> None:
    carrying = np.isfinite(share) & (share > 0)
    bad = np.flatnonzero(((where >= joints) & carrying).any(axis=1))
    if len(bad):
        raise WeightsError(
            f"{user}: vertex {bad[0]} is weighted to joint {where[bad[0]].max()} in JOINTS_{n}, "
            f"but its skin has {joints} joints (numbered from 0)"
        )
