"""Weights of a document of which only some rows change: the others keep their stored bytes."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ....rig import Rig
from ....rig.rig import normalised
from ...weights import neutral_joints
from ..influences import influence_attributes, pack_influences, sorted_influences
from ..read.primitives import primitives
from ..read.read import GltfSource, StoredPart
from .moves import file_joints

ROUNDED_WEIGHT = 1e-12
"""Weights may differ by it from those that loading gave: scaling to a sum of one rounds."""
LOCAL = 0.5
"""Integers stay integers while more than this part of the rows is unchanged; floats are exact."""


def new_influences(rig: Rig, part: StoredPart, saved: StoredPart) -> dict[str, NDArray] | None:
    """Return the attributes that store a part's weights; None if the document's are the same.

    `saved` has the new skin. Rows that loading would read as the weights to be saved stay, and so
    do component types if they can hold what changes. Sets are added as needed, never removed.
    """
    weights: NDArray = rig.weights[part.rows][:, saved.joints]  # type: ignore[index]
    stored: list[tuple[NDArray, NDArray]] = []
    is_same = np.zeros(len(weights), bool)
    if rig.source.document.is_gltf:
        stored, is_same = _stored_rows(rig, part, saved, weights)
        if is_same.all():
            return None
    is_wide = any(joints.dtype.itemsize > 1 for joints, _ in stored)
    if not stored or not is_same.any():
        return influence_attributes(pack_influences(weights), len(saved.joints), is_wide)
    changed = np.flatnonzero(~is_same)
    types = {shares.dtype for _, shares in stored}
    stays = len(types) == 1 and is_same.mean() > LOCAL
    share_type = types.pop() if stays else np.dtype("<f4")
    if share_type.kind == "f":
        joints, shares = pack_influences(weights[changed])
    else:
        joints, shares = _as_integers(weights[changed], share_type)
    number = np.dtype("<u2" if is_wide or joints.max(initial=0) > 255 else "<u1")
    attributes = {}
    for n in range(max(len(joints), len(stored))):
        kinds = (("JOINTS", joints, number), ("WEIGHTS", shares, share_type))
        for k, (name, new, kind) in enumerate(kinds):
            values = np.zeros((len(weights), 4), kind)
            if n < len(stored):
                values[:] = _converted(stored[n][k], kind)
            values[changed] = new[n] if n < len(new) else 0
            attributes[f"{name}_{n}"] = values
    return attributes


def _stored_rows(
    rig: Rig, part: StoredPart, saved: StoredPart, weights: NDArray
) -> tuple[list[tuple[NDArray, NDArray]], NDArray[np.bool_]]:
    """Return the stored sets, and which rows (n,) loading would read as the weights (n, j)."""
    source: GltfSource = rig.source
    document = replace(source.document, warnings=[])  # with memory and caches of its own
    mesh, k = part.primitives[0]
    primitive = primitives(document, mesh)[k]
    read = primitive.weights(len(part.joints)).weights
    loaded = np.zeros((len(weights), len(part.joints))) if read is None else read
    neutral = neutral_joints(source.skeleton)[part.joints]
    if loaded[:, neutral].any():
        loaded = normalised(np.where(neutral, 0.0, loaded))
    origin = file_joints(rig)
    expected, is_same = np.zeros(weights.shape), np.ones(len(weights), bool)
    for slot, joint in enumerate(part.joints):
        if slot < len(saved.joints) and origin[saved.joints[slot]] == joint:
            expected[:, slot] = loaded[:, slot]
        else:  # the skin names another joint by this number now
            is_same &= loaded[:, slot] == 0
    is_same &= np.abs(weights - expected).max(axis=1, initial=0) <= ROUNDED_WEIGHT
    if source.rescaled is not None:
        is_same &= ~source.rescaled[part.rows]
    joints, shares = (
        [primitive.accessor(f"{name}_{n}", "VEC4").stored for n in primitive.influence_sets]
        for name in ("JOINTS", "WEIGHTS")
    )
    if len(saved.joints) < len(part.joints):  # unused slots, too, may name joints that are gone
        for one in joints:
            is_same &= (one < len(saved.joints)).all(axis=1)
    return list(zip(joints, shares, strict=True)), is_same


def _converted(values: NDArray, kind: np.dtype[Any]) -> NDArray:
    """Return stored weights (n, 4) as another type, if it is another one."""
    if kind.kind != "f" or values.dtype.kind == "f":
        return values
    return np.maximum(values / np.iinfo(values.dtype).max, -1.0)


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
