"""Joints of a glTF document that were moved or mended at rest: nodes, bind matrices, motions.

A joint's frame moves within itself by d, which takes three edits. Its inverse bind matrices,
of every skin, become T(-d) IBM. Its node is shifted by what d is in its parent's frame; all that
hangs on it by -d, so that it stays where it is. Keys of translations, which are absolute, are
shifted by as much as the node that they move. Vertices do not move at rest.

An inverse bind matrix that contradicted its node stays in the file until the joint is moved or
holds a vertex: then it becomes the one that the joint was placed by.
"""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ....errors import SkeletonError
from ....rig import Rig
from ..buffer import BufferWriter
from ..constants import CUBICSPLINE
from ..container import Document
from ..nodes import Nodes, node_shifts, target_of
from ..read.accessors import read_accessor

BINDS = "inverseBindMatrices"


@dataclass(frozen=True, eq=False)
class NewValues:
    """Values that take the place of an accessor's."""

    owner: dict[str, Any]  # what refers to them, under `key`
    key: str
    values: NDArray  # (n, width)
    old: int | None  # the accessor that they replace
    target: int | None = None  # of the buffer view

    def store(self, buffer: BufferWriter, stored: dict[Any, int]) -> None:
        """Store them, or refer to equal ones that were `stored` before."""
        same = self.key, self.old, self.target, self.values.tobytes()
        if same not in stored:
            is_share = self.key.startswith("WEIGHTS_") and self.values.dtype.kind != "f"
            stored[same] = buffer.store(self.values, self.old, self.target, normalized=is_share)
        self.owner[self.key] = stored[same]


@np.errstate(over="ignore")  # readers refuse what becomes infinite
def take_moves(document: dict[str, Any], rig: Rig) -> list[NewValues]:
    """Shift the nodes of joints that were moved, and take out of a document what is replaced."""
    source, by = rig.source, own_moves(rig)
    mended = _needed(rig, np.any(by != 0, axis=1))
    if not by.any() and not mended:
        return []
    nodes = Nodes(source.document)
    frame_shifts = np.zeros((len(nodes.raw), 3))
    frame_shifts[source.nodes] = by
    shifts = node_shifts(nodes.local, nodes.parents, frame_shifts)
    for i in np.flatnonzero(shifts.any(axis=1)).tolist():
        node = document["nodes"][i]
        if "matrix" in node:
            node["matrix"][12:15] = np.add(node["matrix"][12:15], shifts[i]).tolist()
        else:
            node["translation"] = np.add(node.get("translation", [0, 0, 0]), shifts[i]).tolist()
    replaced = _binds(document, rig, frame_shifts, mended)
    return replaced + _translations(document, source.document, shifts)


def file_joints(rig: Rig) -> NDArray[np.integer]:
    """Return which joint of its file each joint of a rig is, shape (j,), -1 for none."""
    return np.arange(len(rig.skeleton.joints)) if rig.origin is None else rig.origin


def own_moves(rig: Rig) -> NDArray[np.float64]:
    """Return how far each joint of a rig's file has moved, shape (j, 3), in its own frame."""
    source = rig.source
    by = np.zeros_like(source.skeleton.joints)
    origin = file_joints(rig)
    has_origin = origin >= 0
    old, new = origin[has_origin], rig.skeleton.joints[has_origin]
    is_moved = (new != source.skeleton.joints[old]).any(axis=1, keepdims=True)
    frames = np.linalg.inv(source.inverse)[old, :3, 3]  # a mended joint may be away from its frame
    by[old] = np.where(is_moved, new - frames, 0.0)
    return np.einsum("jab,jb->ja", source.inverse[:, :3, :3], by)


def read_binds(loaded: Document, skin: int) -> NDArray[np.float64]:
    """Return a skin's inverse bind matrices as they are stored, shape (k, 16); refuse none."""
    label, stored = loaded.label("skins", skin), loaded.json["skins"][skin]
    count = len(stored["joints"])
    if BINDS in stored:
        values = read_accessor(loaded, stored[BINDS], "MAT4", label).astype(np.float64)
        missing = np.eye(4).reshape(1, 16).repeat(max(count - len(values), 0), axis=0)
        values = np.concatenate([values, missing])
        if count == 1 or not (values[:count] == np.eye(4).ravel()).all():
            return values
    raise SkeletonError(
        f"{label} has no inverse bind matrices, so that its joints cannot be moved within "
        "its mesh; set the rig's source to None to write a new file instead"
    )


def _needed(rig: Rig, is_moved: NDArray[np.bool_]) -> dict[int, dict[int, NDArray]]:
    """Return the mended matrices that must be saved: of joints that are moved or hold a vertex.

    A document that was made of another format has no matrices of its own to keep.
    """
    source, weights = rig.source, rig.weights
    assert weights is not None
    if not source.document.is_gltf:
        frames = np.linalg.inv(source.inverse)[:, :3, 3]
        is_moved = is_moved | np.isclose(frames, source.skeleton.joints).all(axis=1)
    origin = file_joints(rig)
    needed: dict[int, dict[int, NDArray]] = {}
    for part in source.parts:
        mended = source.mended.get(part.skin, {})
        is_held = np.zeros(len(is_moved), bool)
        if mended:
            columns = np.flatnonzero((origin >= 0) & weights[part.rows].any(axis=0))
            is_held[origin[columns]] = True
        rows = {k: m for k, m in mended.items() if (is_held | is_moved)[part.joints[k]]}
        if rows:
            needed.setdefault(part.skin, {}).update(rows)
    return needed


def _binds(
    document: dict[str, Any], rig: Rig, frame_shifts: NDArray, mended: dict[int, dict[int, NDArray]]
) -> list[NewValues]:
    replaced = []
    for i, skin in enumerate(document.get("skins", [])):
        shift = frame_shifts[skin.get("joints", [])]
        if not shift.any() and i not in mended:
            continue
        values = read_binds(rig.source.document, i)
        for slot, matrix in mended.get(i, {}).items():
            values[slot] = matrix.T.ravel()
        values[: len(shift), 12:15] -= shift
        replaced.append(NewValues(skin, BINDS, values.astype("<f4"), skin.pop(BINDS)))
    return replaced


def _translations(document: dict[str, Any], loaded: Document, shifts: NDArray) -> list[NewValues]:
    replaced = []
    for i, animation in enumerate(document.get("animations", [])):
        label = loaded.label("animations", i)
        samplers, channels = animation["samplers"], animation["channels"]
        uses = Counter(channel["sampler"] for channel in channels)
        for channel in channels:
            node, path = target_of(channel)
            if path != "translation" or node is None or not shifts[node].any():
                continue
            sampler = samplers[channel["sampler"]]
            if uses[channel["sampler"]] > 1:  # what moves other nodes, too, stays
                channel["sampler"] = len(samplers)
                samplers.append(sampler := dict(sampler))
            old = sampler.pop("output")
            values = read_accessor(loaded, old, "VEC3", label).astype(np.float64)
            if sampler.get("interpolation") == CUBICSPLINE:
                values[1::3] += shifts[node]  # between the tangents
            else:
                values += shifts[node]
            replaced.append(NewValues(sampler, "output", values.astype("<f4"), old))
    return replaced
