"""Nodes that are the bones of a document whose meshes have no skin.

Such documents are armatures that were exported without a modifier, and avatars whose meshes are
not skinned. VRM lists its bones. A skin that no mesh uses lists its joints. Otherwise bones are
trees of empty nodes that end in empty nodes: an empty node that ends in meshes is a group.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ....runtime.display import listed
from ..container import Document, extensions, indices
from ..nodes import Nodes

NOT_EMPTY = ("mesh", "camera", "skin", "KHR_lights_punctual", "EXT_mesh_gpu_instancing")
MIN_CHAIN = 3
"""Nodes of a chain of bones. Two nodes are one if their tree has no others."""
BOX_MARGIN = 0.1
"""How far bones may lie outside of the meshes' bounding box, in diagonals of it."""
COINCIDENT_BONES = 1e-6
"""Tolerance in the same diagonals."""


@dataclass
class Bones:
    """Nodes that are bones."""

    joints: list[int] = field(default_factory=list)  # ascending
    tops: set[int] = field(default_factory=set)
    """The topmost nodes of trees of empty nodes. These are often the armature's own node, so that a
    mesh directly below one of them is part of the body."""
    why_none: str = ""  # why there are no joints, where the nodes look like bones


def find_bones(
    document: Document, nodes: Nodes, bounds: tuple[NDArray, NDArray] | None = None
) -> Bones:
    """Return the bones of a document; `bounds` are those of its meshes, if it has any."""
    empty = _empty(nodes)
    listed_bones = set(human_bones(document))
    if listed_bones:
        below = nodes.nearest(listed_bones)
        return Bones(sorted(listed_bones | {i for i in empty if below[i] >= 0}))
    skins = [indices(skin, "joints", "a skin") for skin in document.items("skins")]
    if any(skins):
        joints = sorted({node for skin in skins for node in skin})
        for node in joints:
            document.item("nodes", node, "a skin")
        return Bones(joints)
    return _trees(nodes, empty, bounds)


def human_bones(document: Document) -> dict[int, str]:
    """Return VRM's name of each node that its humanoid lists."""
    names: dict[int, str] = {}
    for key, item in extensions(document.json).items():
        if key not in ("VRM", "VRMC_vrm") or not isinstance(item, dict):
            continue
        humanoid = item.get("humanoid")
        bones = humanoid.get("humanBones") if isinstance(humanoid, dict) else None
        for name, node in _listed(bones):
            if type(node) is int and 0 <= node < len(document.items("nodes")):
                names.setdefault(node, str(name))
    return names


def _listed(bones: Any) -> Iterable[tuple[Any, Any]]:
    """Yield name and node of each bone: version 0 has a list of them, version 1 an object."""
    if isinstance(bones, list):
        return [(b.get("bone"), b.get("node")) for b in bones if isinstance(b, dict)]
    if isinstance(bones, dict):
        return [(name, b.get("node")) for name, b in bones.items() if isinstance(b, dict)]
    return []


def _empty(nodes: Nodes) -> set[int]:
    """Return the nodes of the scene without mesh, camera or light."""
    used = {i: nodes.raw[i].keys() | extensions(nodes.raw[i]).keys() for i in nodes.in_scene()}
    return {i for i, keys in used.items() if keys.isdisjoint(NOT_EMPTY)}


def _trees(nodes: Nodes, empty: set[int], bounds: tuple[NDArray, NDArray] | None) -> Bones:
    """Return the trees of empty nodes that are bones."""
    children: dict[int, list[int]] = {i: [] for i in range(len(nodes.raw))}
    for i, parent in enumerate(nodes.parents):
        if parent >= 0:
            children[parent].append(i)
    height = _heights(nodes, empty, children)
    low, high = bounds or (np.full(3, -np.inf), np.full(3, np.inf))
    diagonal = float(np.linalg.norm(high - low)) if bounds else 0.0
    places = nodes.world[:, :3, 3]
    bones, outside = Bones(), []
    for root in sorted(i for i in height if nodes.parents[i] not in height):
        whole = _below(root, children, height)
        if height[root] < MIN_CHAIN and (height[root] < 2 or len(whole) != 2):
            continue
        top = root
        while len(below := [k for k in children[top] if k in height]) == 1:
            if np.abs(places[below[0]] - places[root]).max() > COINCIDENT_BONES * diagonal:
                break
            top = below[0]  # a group in the place of what it holds
        tree = _below(top, children, height)
        groups = [k for i in tree if i != top for k in children[i] if k in empty - height.keys()]
        tree += [k for i in groups for k in _below(i, children, empty)]
        at = places[tree]
        if len(tree) < 2 or np.ptp(at, axis=0).max() <= COINCIDENT_BONES * diagonal:
            continue
        near = ((at >= low - BOX_MARGIN * diagonal) & (at <= high + BOX_MARGIN * diagonal)).all(
            axis=1
        )
        if near.mean() < 0.5:
            outside.append(nodes.document.label("nodes", top))
            continue
        bones.joints += tree
        bones.tops.add(top)
    bones.joints.sort()
    if outside and not bones.joints:
        bones.why_none = (
            f"it has no skin, and what could be its bones (below {listed(outside)}) lies outside "
            "of its mesh. Give the mesh and the armature the same scale and axes, and export again"
        )
    return bones


def _heights(nodes: Nodes, empty: set[int], children: dict[int, list[int]]) -> dict[int, int]:
    """Return for empty nodes above or at an empty end how many nodes down to the farthest."""
    height: dict[int, int] = {}
    has_mesh: set[int] = set()
    for level in reversed(nodes.levels):
        for i in level.tolist():
            if "mesh" in nodes.raw[i] or any(k in has_mesh for k in children[i]):
                has_mesh.add(i)
            if i not in empty:
                continue
            below = [height[k] for k in children[i] if k in height]
            if below or i not in has_mesh:
                height[i] = 1 + max(below, default=0)
    return height


def _below(top: int, children: dict[int, list[int]], chosen: Collection[int]) -> list[int]:
    """Return a node and all chosen nodes below it that chosen nodes connect to it."""
    reached = [top]
    for i in reached:  # grows
        reached += [k for k in children[i] if k in chosen]
    return reached
