"""Joints of a glTF document that are added, removed or reparented: nodes and skins.

A joint goes on to move against its parent as it did (`skinning.restructure`). So a node that is
hung on another joint stands behind a node that does not move, which leads from the bind frame of
the new parent to that of the old one: no key of any motion changes. A removed joint stays as such
a node, too; no skin names it any more. Nodes keep their numbers.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ....errors import SkeletonError
from ....rig import Rig, with_origin
from ..nodes import Nodes, target_of
from ..read.read import GltfSource, StoredPart
from .moves import BINDS, NewValues, own_moves, read_binds


def take_structure(
    document: dict[str, Any], rig: Rig, moves: list[NewValues]
) -> tuple[list[StoredPart], list[NewValues]]:
    """Change the nodes and skins of a document to those of a rig with other joints."""
    source: GltfSource = rig.source
    has_its_joints = rig.origin is None or np.array_equal(rig.origin, np.arange(len(source.nodes)))
    if has_its_joints and np.array_equal(rig.skeleton.parents, source.skeleton.parents):
        return source.parts, moves
    edit = _Edit(document, rig)
    edit.freeze_removed_joints()
    edit.add_joints()
    edit.reparent()
    return edit.skins(moves)


class _Edit:
    """A document whose joints change."""

    def __init__(self, document: dict[str, Any], rig: Rig) -> None:
        source: GltfSource = rig.source
        self.document, self.rig, self.source = document, rig, source
        self.nodes = Nodes(replace(source.document, json=document))
        self.parents = source.skeleton.parents
        self._base = -1
        self.inverse = source.inverse.copy()
        self.inverse[:, :3, 3] -= own_moves(rig)
        assert rig.origin is not None
        self.origin = rig.origin
        self.number = {int(f): j for j, f in enumerate(rig.origin) if f >= 0}
        # The node and the inverse bind matrix of each of the rig's joints.
        self.node = {j: source.nodes[f] for f, j in self.number.items()}
        self.bind = {j: self.inverse[f] for f, j in self.number.items()}

    def freeze_removed_joints(self) -> None:
        """Freeze removed joints relative to their parents."""
        removed = [f for f in range(len(self.source.nodes)) if f not in self.number]
        for f in removed:
            frame = self._frame_above(f) @ np.linalg.inv(self.inverse[f])
            node = self.document["nodes"][self.source.nodes[f]]
            _set_matrix(node, np.linalg.inv(self._behind(f)) @ frame)
        frozen = {self.source.nodes[f] for f in removed}
        animations = self.document.get("animations", [])
        for animation in animations:
            animation["channels"] = [
                channel
                for channel in animation["channels"]
                if target_of(channel)[0] not in frozen or target_of(channel)[1] == "weights"
            ]
        animations[:] = [animation for animation in animations if animation["channels"]]
        if not animations:  # glTF has no motion of nothing
            self.document.pop("animations", None)

    def add_joints(self) -> None:
        """Make nodes for joints that were added, turned as their parents are."""
        skeleton = self.rig.skeleton
        for j in np.argsort(skeleton.depth, kind="stable").tolist():
            if self.origin[j] >= 0:
                continue
            above, place = int(skeleton.parents[j]), skeleton.joints[j]
            new: dict[str, Any] = {"name": skeleton.names[j]}
            frame = np.eye(4) if above < 0 else np.linalg.inv(self.bind[above])
            frame[:3, 3] = place
            self.bind[j] = np.linalg.inv(frame)
            if above < 0:
                self.node[j] = self._add_root(new, self.rig.world @ frame)
            else:
                new["translation"] = (self.bind[above] @ [*place, 1])[:3].tolist()
                self.node[j] = self._add(new, self.node[above])

    def reparent(self) -> None:
        """Hang the nodes of joints on those of their new parents."""
        for f, j in self.number.items():
            above = int(self.parents[f])
            while above >= 0 and above not in self.number:
                above = int(self.parents[above])
            new_parent = int(self.rig.skeleton.parents[j])
            if new_parent == (self.number[above] if above >= 0 else -1):
                continue
            frame = np.linalg.inv(self._frame_above(f)) @ self._behind(f)
            node = self.node[j]
            holder: dict[str, Any] = {"children": [node]}
            self._take_off(node)
            if new_parent < 0:
                self._add_root(holder, self.rig.world @ frame)
            else:
                _set_matrix(holder, self.bind[new_parent] @ frame)
                self._add(holder, self.node[new_parent])

    def skins(self, moves: list[NewValues]) -> tuple[list[StoredPart], list[NewValues]]:
        """Set the joints of the skins and their inverse bind matrices."""
        parts, replaced = self.source.parts, list(moves)
        joints: dict[int, list[int]] = {}
        for part in parts:
            if part.skin not in joints:
                joints[part.skin] = self._skin(part, replaced)
        return [replace(part, joints=joints[part.skin]) for part in parts], replaced

    def _skin(self, part: StoredPart, replaced: list[NewValues]) -> list[int]:
        skin, loaded = self.document["skins"][part.skin], self.source.document
        before = read_binds(loaded, part.skin)
        values = before
        for move in [move for move in replaced if move.owner is skin and move.key == BINDS]:
            values = move.values.astype(np.float64)
            replaced.remove(move)
        skin.pop(BINDS, None)
        slots = [slot for slot, f in enumerate(part.joints) if f in self.number]
        joints = [self.number[part.joints[slot]] for slot in slots]
        like = with_origin(self.rig.skeleton, self.origin)
        added = [
            j
            for j in np.flatnonzero(self.origin < 0).tolist()
            if max(int(self.origin[like[j]]), 0) in part.joints
        ]
        if not joints + added:
            label = loaded.label("skins", part.skin)
            raise SkeletonError(f"of {label} no joint is left; keep at least one")
        # A skin's own space may be another than the rig's.
        first = self.source.mended.get(part.skin, {}).get(0, before[0].reshape(4, 4).T)
        to_rig = np.linalg.inv(self.source.inverse[part.joints[0]]) @ first
        rows = [values[slot] for slot in slots]
        rows += [(self.bind[j] @ to_rig).T.ravel() for j in added]
        skin["joints"] = [self.node[j] for j in joints + added]
        old = loaded.json["skins"][part.skin][BINDS]
        replaced.append(NewValues(skin, BINDS, np.array(rows).astype("<f4"), old))
        return joints + added

    def _frame_above(self, f: int) -> NDArray[np.float64]:
        """Return the inverse bind matrix of a joint's parent; the world matrix for a root."""
        above = int(self.parents[f])
        return self.inverse[above] if above >= 0 else self.rig.world

    def _behind(self, f: int) -> NDArray[np.float64]:
        """Return the rest matrix of a joint's parent node in its parent joint, or in the scene."""
        above = int(self.parents[f])
        stop = self.source.nodes[above] if above >= 0 else -1
        node, matrix = self.nodes.parents[self.source.nodes[f]], np.eye(4)
        while node != stop:
            matrix = self.nodes.local[node] @ matrix
            node = self.nodes.parents[node]
        return matrix

    def _roots(self) -> list[list[int]]:
        scenes = self.document.get("scenes", [])
        return [scene["nodes"] for scene in scenes if "nodes" in scene]

    def _add(self, node: dict[str, Any], on: int) -> int:
        """Add a node below another one."""
        nodes = self.document["nodes"]
        nodes.append(node)
        nodes[on].setdefault("children", []).append(len(nodes) - 1)
        return len(nodes) - 1

    def _add_root(self, node: dict[str, Any], world: NDArray[np.float64]) -> int:
        """Add a node beside the first root joint: the joints of a skin need a common ancestor."""
        first = self.source.nodes[int(np.flatnonzero(self.parents < 0)[0])]
        base = self.nodes.parents[first]
        if base < 0:
            base = self._base if self._base >= 0 else self._new_base()
            _set_matrix(node, world)
        else:
            _set_matrix(node, np.linalg.inv(self.nodes.world[base]) @ world)
        for skin in {part.skin for part in self.source.parts}:
            self.document["skins"][skin].pop("skeleton", None)  # it need not be above this one
        return self._add(node, base)

    def _new_base(self) -> int:
        """Add a node above the nodes of all root joints."""
        roots = {self.source.nodes[f] for f in np.flatnonzero(self.parents < 0)}
        roots = {node for node in roots if self.nodes.parents[node] < 0}
        nodes = self.document["nodes"]
        nodes.append({"name": "skeleton", "children": sorted(roots)})
        self._base = len(nodes) - 1
        for listed in self._roots():
            if roots & set(listed):
                listed[:] = [node for node in listed if node not in roots] + [self._base]
        return self._base

    def _take_off(self, node: int) -> None:
        """Remove a node from its parent and from the roots of scenes."""
        for roots in self._roots():
            if node in roots:
                roots.remove(node)
        for owner in self.document["nodes"]:
            if node in owner.get("children", []):
                owner["children"].remove(node)
                if not owner["children"]:
                    del owner["children"]


def _set_matrix(node: dict[str, Any], matrix: NDArray[np.float64]) -> None:
    """Set a node's matrix in place of its translation, rotation and scale."""
    for key in ("translation", "rotation", "scale", "matrix"):
        node.pop(key, None)
    if not np.allclose(matrix, np.eye(4), rtol=0, atol=1e-12):
        exact = matrix.copy()
        exact[3] = [0, 0, 0, 1]
        node["matrix"] = exact.T.ravel().tolist()
