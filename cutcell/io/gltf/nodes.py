"""The node tree of a glTF document: parents and matrices."""

from __future__ import annotations

import re
from collections.abc import Collection
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ...errors import FileError, SkeletonError
from ...rig.checks import MAX_COORDINATE
from ...rig.transforms import composed
from .container import Document, extensions, indices

NODE_POINTER = re.compile("/nodes/(0|[1-9][0-9]{0,8})/(translation|rotation|scale|weights)")


class Nodes:
    """All nodes as arrays, at rest."""

    def __init__(self, document: Document) -> None:
        self.document = document
        self.raw = document.items("nodes")
        self.parents = _parents(document)  # -1 for none
        self.levels = _levels(document, self.parents)  # nodes by depth, roots first
        self.depth = np.zeros(len(self.raw), int)
        for depth, level in enumerate(self.levels):
            self.depth[level] = depth
        count = len(self.raw)
        self.translation = np.zeros((count, 3))
        self.rotation = np.tile([0.0, 0.0, 0.0, 1.0], (count, 1))  # quaternions (x, y, z, w)
        self.scale = np.ones((count, 3))
        self.local = self._read_transforms()  # (k, 4, 4)
        with np.errstate(over="ignore", invalid="ignore"):  # refused below
            self.world = self.relative_to([])
        far = np.flatnonzero(~(np.abs(self.world) <= MAX_COORDINATE).all(axis=(1, 2)))
        if len(far):
            raise FileError(
                f"{document.label('nodes', int(far[0]))}: its place in the scene has numbers above "
                f"{MAX_COORDINATE:g}; give it and the nodes above it smaller transforms"
            )

    def _read_transforms(self) -> NDArray[np.float64]:
        """Fill translation, rotation and scale; return the matrices."""
        for i, node in enumerate(self.raw):
            for key in node.keys() & {"translation", "rotation", "scale"}:
                target = getattr(self, key)
                target[i] = self._numbers(i, key, target.shape[1])
        local = compose(self.translation, self.rotation, self.scale)
        for i, node in enumerate(self.raw):
            if "matrix" in node:
                local[i] = self._numbers(i, "matrix", 16).reshape(4, 4).T
                self.translation[i], self.rotation[i], self.scale[i] = decompose(local[i])
        return local

    def _numbers(self, i: int, key: str, count: int) -> NDArray:
        value: Any = self.raw[i][key]
        try:
            numbers = np.array(value, np.float64)
        except (TypeError, ValueError, OverflowError):
            numbers = np.zeros(0)
        if numbers.shape != (count,) or not (np.abs(numbers) <= MAX_COORDINATE).all():
            raise FileError(
                f'{self.document.label("nodes", i)}: "{key}" must be {count} finite numbers, '
                f"{MAX_COORDINATE:g} at most"
            )
        return numbers

    def with_ancestors(self, nodes: list[int]) -> list[int]:
        """Return some nodes and all that are above any of them, each once."""
        reached: set[int] = set()
        for node in nodes:
            while node >= 0 and node not in reached:
                reached.add(node)
                node = self.parents[node]
        return sorted(reached)

    def nearest(self, nodes: Collection[int]) -> list[int]:
        """Return for each node the nearest of some, itself or above it; -1 for none."""
        nearest = [-1] * len(self.raw)
        for level in self.levels:
            for i in level.tolist():
                parent = self.parents[i]
                nearest[i] = i if i in nodes else nearest[parent] if parent >= 0 else -1
        return nearest

    def relative_to(self, nodes: list[int]) -> NDArray[np.float64]:
        """Return matrices, shape (k, 4, 4), to the nearest of some nodes above, or the scene."""
        relative, parents = self.local.copy(), np.array(self.parents, int)
        relative[nodes], parents[nodes] = np.eye(4), -1
        return composed(relative, parents)

    def in_scene(self) -> list[int]:
        """Return the nodes of the default scene, ascending; all when there is no scene."""
        document = self.document
        if not document.items("scenes"):
            return list(range(len(self.raw)))
        chosen = document.json.get("scene", 0)
        reached = set(indices(document.item("scenes", chosen, "scene"), "nodes", "the scene"))
        for i in reached:
            document.item("nodes", i, "the scene")
        for level in self.levels:
            reached |= {int(i) for i in level if self.parents[i] in reached}
        return sorted(reached)


def _parents(document: Document) -> list[int]:
    nodes = document.items("nodes")
    parents = [-1] * len(nodes)
    for i, node in enumerate(nodes):
        for child in indices(node, "children", f"nodes[{i}]"):
            document.item("nodes", child, f"nodes[{i}]")
            if parents[child] not in (-1, i):
                raise SkeletonError(
                    f"{document.label('nodes', child)} hangs on two nodes, "
                    f"{document.label('nodes', parents[child])} and {document.label('nodes', i)}"
                )
            parents[child] = i
    return parents


def _levels(document: Document, parents: list[int]) -> list[NDArray]:
    children: dict[int, list[int]] = {}
    for i, parent in enumerate(parents):
        children.setdefault(parent, []).append(i)
    levels = [children.get(-1, [])]
    while levels[-1]:
        levels.append([c for i in levels[-1] for c in children.get(i, ())])
    reached = {i for level in levels for i in level}
    if len(reached) < len(parents):
        stuck = next(i for i in range(len(parents)) if i not in reached)
        raise SkeletonError(
            f"the node tree has a cycle at {document.label('nodes', stuck)}: a node hangs on itself"
        )
    return [np.array(level, int) for level in levels[:-1]]


def target_of(channel: dict[str, Any]) -> tuple[Any, Any]:
    """Return the node and the property that a channel moves; None and any other pointer."""
    target = channel["target"]
    extension = extensions(target).get("KHR_animation_pointer")
    if not isinstance(extension, dict):
        return target.get("node"), target.get("path")
    pointer = str(extension.get("pointer"))
    match = NODE_POINTER.fullmatch(pointer)
    return (int(match[1]), match[2]) if match else (None, pointer)


def node_shifts(
    local: NDArray[np.float64], parents: ArrayLike, frame_shifts: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Return how far nodes are shifted in their parents' frames when frames move, (k, 3)."""
    above = np.asarray(parents)
    shifts = np.einsum("kab,kb->ka", local[:, :3, :3], frame_shifts)
    return shifts - np.where(above[:, None] >= 0, frame_shifts[above], 0.0)


def compose(translation: NDArray, rotation: NDArray, scale: NDArray) -> NDArray:
    """Return matrices (..., 4, 4) from translations, quaternions (x, y, z, w) and scales."""
    norm = np.linalg.norm(rotation, axis=-1, keepdims=True)
    with np.errstate(invalid="ignore", divide="ignore"):
        q = np.where(norm == 0, [0.0, 0.0, 0.0, 1.0], rotation / norm)
    x, y, z, w = np.moveaxis(q, -1, 0)
    rows = (
        (1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)),
        (2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)),
        (2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)),
    )
    out = np.zeros((*q.shape[:-1], 4, 4))
    out[..., :3, :3] = np.moveaxis(np.array(rows), (0, 1), (-2, -1))
    out[..., :3, :3] *= scale[..., None, :]
    out[..., :3, 3] = translation
    out[..., 3, 3] = 1
    return out


def decompose(matrices: NDArray) -> tuple[NDArray, NDArray, NDArray]:
    """Split matrices (..., 4, 4) into translations, quaternions and scales; shear is lost."""
    linear = matrices[..., :3, :3]
    scale = np.linalg.norm(linear, axis=-2)
    scale[..., 0] *= np.where(np.linalg.det(linear) < 0, -1, 1)
    turn = linear / np.where(scale == 0, 1, scale)[..., None, :]
    # The quaternion is the eigenvector of the largest eigenvalue (Bar-Itzhack 2000).
    trace = np.trace(turn, axis1=-2, axis2=-1)
    k = np.zeros((*trace.shape, 4, 4))
    k[..., :3, :3] = turn + np.swapaxes(turn, -1, -2) - trace[..., None, None] * np.eye(3)
    for i, (a, b) in enumerate([(2, 1), (0, 2), (1, 0)]):
        k[..., i, 3] = k[..., 3, i] = turn[..., a, b] - turn[..., b, a]
    k[..., 3, 3] = trace
    return matrices[..., :3, 3], np.linalg.eigh(k)[1][..., -1], scale
