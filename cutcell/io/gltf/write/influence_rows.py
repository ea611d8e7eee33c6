"""Weights of a document of which only some rows change: the others keep their stored bytes."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ....rig import Rig
from ....rig.rig import normalised
from ...weights import neutral_joints
from ..buffer import BufferWriter
from ..influences import pack_influences, sorted_influences
from ..read.accessors import find_accessor
from ..read.primitives import influence_sets, read_weights
from ..read.read import GltfSource, StoredPart
from .moves import file_joints

SAME = 1e-12
"""Weights may differ by it from those that loading gave: scaling to a sum of one rounds."""
LOCAL = 0.5
"""Integers stay integers while more than this part of the rows is unchanged; floats are exact."""


@dataclass(frozen=True, eq=False)
class StoredRows:
    """Influences of a part as its document stores them."""

    joints: list[NDArray]  # (n, 4) each
    shares: list[NDArray]  # (n, 4) each
    is_same: NDArray[np.bool_]  # (n,): which loading would read as the weights to be saved


def stored_rows(rig: Rig, part: StoredPart, saved: StoredPart) -> StoredRows:
    """Compare the stored weights of a part with those of a rig; `saved` has the new skin."""
    assert rig.weights is not None
    source: GltfSource = rig.source
    document = replace(source.document, warnings=[])  # with memory and caches of its own
    mesh, k = part.primitives[0]
    primitive = document.json["meshes"][mesh]["primitives"][k]
    count = part.rows.stop - part.rows.start
    read = read_weights(document, primitive, count, len(part.joints), part.label).weights
    loaded = np.zeros((count, len(part.joints))) if read is None else read
    neutral = neutral_joints(source.skeleton)[part.joints]
    if loaded[:, neutral].any():
        loaded = normalised(np.where(neutral, 0.0, loaded))
    origin = file_joints(rig)
    expected, is_same = np.zeros((count, len(saved.joints))), np.ones(count, bool)
    for slot, joint in enumerate(part.joints):
        if slot < len(saved.joints) and origin[saved.joints[slot]] == joint:
            expected[:, slot] = loaded[:, slot]
        else:  # the skin names another joint by this number now
            is_same &= loaded[:, slot] == 0
    weights = rig.weights[part.rows][:, saved.joints]
    is_same &= np.abs(weights - expected).max(axis=1, initial=0) <= SAME
    if source.rescaled is not None:
        is_same &= ~source.rescaled[part.rows]
    named = primitive["attributes"]
    sets = influence_sets(named)
    joints, shares = (
        [find_accessor(document, named[f"{name}_{n}"], "VEC4", part.label).stored() for n in sets]
        for name in ("JOINTS", "WEIGHTS")
    )
    if len(saved.joints) < len(part.joints):  # unused slots, too, may name joints that are gone
        for one in joints:
            is_same &= (one < len(saved.joints)).all(axis=1)
    return StoredRows(joints, shares, is_same)


def store_changed_rows(buffer: BufferWriter, weights: NDArray, rows: StoredRows,
                       old: dict[str, int]) -> dict[str, int]:  # fmt: skip
    """Store weights (n, j) of which some rows are a document's; return accessors by attribute.

    Component types stay if they can hold what changes. Sets are added as needed, never removed.
    """
    changed = np.flatnonzero(~rows.is_same)
    types = {one.dtype for one in rows.shares}
    stays = len(types) == 1 and rows.is_same.mean() > LOCAL
    share_type = types.pop() if stays else np.dtype("<f4")
    if share_type.kind == "f":
        joints, shares = pack_influences(weights[changed])
    else:
        joints, shares = _as_integers(weights[changed], share_type)
    stored: dict[str, int] = {}
    joint_type = max((one.dtype for one in rows.joints), key=lambda dtype: dtype.itemsize)
    if joints.max(initial=0) > np.iinfo(joint_type).max:
        joint_type = np.dtype("<u2")
    stored_shares = [_converted(one, share_type) for one in rows.shares]
    for n in range(max(len(joints), len(rows.joints))):
        where = _with_rows(rows.joints, n, joints, changed, joint_type)
        share = _with_rows(stored_shares, n, shares, changed, share_type)
        for name, values in ((f"JOINTS_{n}", where), (f"WEIGHTS_{n}", share)):
            stored[name] = buffer.store(values, old.get(name))
        if share_type.kind != "f":
            buffer.accessors[stored[f"WEIGHTS_{n}"]]["normalized"] = True
    return stored


def _converted(shares: NDArray, kind: np.dtype[Any]) -> NDArray:
    """Return stored weights (n, 4) as another type, the same if it is theirs."""
    if shares.dtype == kind or shares.dtype.kind == "f":
        return shares
    return np.maximum(shares / np.iinfo(shares.dtype).max, -1.0).astype(kind)


def _with_rows(
    stored: list[NDArray], n: int, new: NDArray, changed: NDArray[np.intp], kind: np.dtype[Any]
) -> NDArray:
    """Return set n with rows that changed; shapes stored (n, 4), new (s, c, 4)."""
    values = np.zeros(stored[0].shape, kind)
    if n < len(stored):
        values[:] = stored[n]
    values[changed] = new[n] if n < len(new) else 0
    return values


def _as_integers(weights: NDArray, kind: np.dtype[Any]) -> tuple[NDArray, NDArray]:
    """Sort weights (n, j) as `pack_influences` does, as integers whose sum stands for one."""
    one = np.iinfo(kind).max
    exact = normalised(weights) * one
    whole = np.floor(exact)
    rest = np.rint(exact.sum(axis=1) - whole.sum(axis=1))[:, None]
    order = np.argsort(whole - exact, axis=1, kind="stable")  # the largest fractions first
    np.put_along_axis(
        whole, order, np.take_along_axis(whole, order, 1) + (np.arange(exact.shape[1]) < rest), 1
    )
    rows, columns = np.nonzero(whole)
    return sorted_influences(rows, columns, whole[rows, columns].astype(kind), len(weights))
