"""From glTF skins to one skeleton in one space.

The space is the bind space of the first skin: there vertices have the positions of their accessor.
A joint's rest position is where its inverse bind matrix comes from, inverse(IBM) · 0.
"""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from ....errors import FileError, SkeletonError
from ....rig import Skeleton
from ..container import Document, indices
from ..nodes import Nodes
from .accessors import read_accessor


@dataclass(eq=False)
class Bind:
    """All joints of a file, and how each skin's vertices get into the rig's space."""

    nodes: list[int] = field(default_factory=list)
    """The node of each joint."""
    inverse: list[NDArray] = field(default_factory=list)
    """Inverse bind matrix of each joint, for vertices in the rig's space."""
    skins: dict[int, list[int]] = field(default_factory=dict)
    """Joint of the rig for each joint of a skin."""
    to_rig: dict[int, NDArray] = field(default_factory=dict)
    """From a skin's bind space to the rig's space."""
    world: NDArray = field(default_factory=lambda: np.eye(4))
    """From the rig's space to the scene, at rest."""
    unbound: set[int] = field(default_factory=set)
    """Joints whose skin has no inverse bind matrices to take a position from."""


def read_bind(
    document: Document, nodes: Nodes, skins: list[int], world: NDArray | None = None
) -> Bind:
    """Bring the skins of a file together; the first one sets the space.

    `world` leads from there to the scene; the joints at rest say where it is when left out.
    """
    bind = Bind()
    place: dict[int, int] = {}
    for skin in skins:
        joints = _skin_joints(document, skin)
        inverse, has_binds = _inverse_binds(document, skin, joints)
        shared = [k for k, node in enumerate(joints) if node in place]
        if not bind.nodes:
            to_rig = np.eye(4)
            bind.world = _rest_world(nodes, joints, inverse) if world is None else world
        elif shared:
            reference = bind.inverse[place[joints[shared[0]]]]
            to_rig = np.linalg.inv(reference) @ inverse[shared[0]]
        else:
            to_rig = np.linalg.inv(bind.world) @ _rest_world(nodes, joints, inverse)
        if not _invertible(to_rig):
            raise SkeletonError(
                f"{document.label('skins', skin)}: its inverse bind matrices cannot be inverted"
            )
        moved = inverse @ np.linalg.inv(to_rig)
        for k, node in enumerate(joints):
            if node not in place:
                place[node] = len(bind.nodes)
                bind.nodes.append(node)
                bind.inverse.append(moved[k])
                if not has_binds and len(joints) > 1:
                    bind.unbound.add(place[node])
        bind.skins[skin] = [place[node] for node in joints]
        bind.to_rig[skin] = to_rig
    return bind


def _skin_joints(document: Document, skin: int) -> list[int]:
    user = document.label("skins", skin)
    joints = indices(document.items("skins")[skin], "joints", user)
    if not joints:
        raise SkeletonError(f"{user} has no joints")
    for node in joints:
        document.item("nodes", node, user)
    twice = next((node for node, times in Counter(joints).items() if times > 1), None)
    if twice is not None:
        raise SkeletonError(f"{user} names {document.label('nodes', twice)} twice as a joint")
    return joints


def _inverse_binds(document: Document, skin: int, joints: list[int]) -> tuple[NDArray, bool]:
    owner, user = document.items("skins")[skin], document.label("skins", skin)
    if "inverseBindMatrices" not in owner:
        return np.tile(np.eye(4), (len(joints), 1, 1)), False
    stored = read_accessor(document, owner["inverseBindMatrices"], "MAT4", user)
    if len(stored) < len(joints):
        raise SkeletonError(
            f"{user} has {len(joints)} joints but {len(stored)} inverse bind matrices"
        )
    inverse = stored[: len(joints)].astype(np.float64).reshape(-1, 4, 4).transpose(0, 2, 1)
    bad = np.flatnonzero(~_invertible(inverse))
    if len(bad):
        raise SkeletonError(
            f"{user}: the inverse bind matrix of the joint "
            f"{document.label('nodes', joints[bad[0]])} cannot be inverted"
        )
    inverse = inverse.copy()
    inverse[:, 3] = [0, 0, 0, 1]  # exporters leave rounding noise here
    return inverse, True


def _invertible(matrices: NDArray) -> NDArray[np.bool_]:
    """Return which matrices, shape (..., 4, 4), can be inverted."""
    linear = matrices[..., :3, :3]
    with np.errstate(over="ignore", invalid="ignore"):
        size = np.linalg.norm(linear, axis=-2).prod(axis=-1)
        finite = np.isfinite(matrices).all(axis=(-2, -1)) & np.isfinite(size)
        return finite & (size > 0) & (np.abs(np.linalg.det(linear)) > 1e-9 * size)


def _rest_world(nodes: Nodes, joints: list[int], inverse: NDArray) -> NDArray:
    """Return the matrix from a skin's bind space to the scene, by its topmost joint.

    The other joints may be posed; the topmost one seldom is.
    """
    for k in np.argsort(nodes.depth[joints], kind="stable").tolist():
        world = nodes.world[joints[k]] @ inverse[k]
        if _invertible(world):  # a joint may be scaled to nothing to hide what it holds
            return world
    return np.eye(4)


def read_skeleton(nodes: Nodes, bind: Bind) -> Skeleton:
    """Return the joints with positions, orientations, parents and unique names."""
    place = {node: j for j, node in enumerate(bind.nodes)} | {-1: -1}
    nearest = [*nodes.nearest(set(bind.nodes)), -1]  # the last is the parent of roots
    parents = [place[nearest[nodes.parents[node]]] for node in bind.nodes]
    at_rest = np.linalg.inv(np.array(bind.inverse))
    if bind.unbound:
        by_nodes = np.linalg.inv(bind.world) @ nodes.world[bind.nodes]
        unbound = sorted(bind.unbound)
        at_rest[unbound] = by_nodes[unbound]
    positions = at_rest[:, :3, 3]
    if not np.isfinite(positions).all():
        raise FileError("a joint has no finite rest position")
    names = unique_names([nodes.raw[node].get("name") for node in bind.nodes])
    orientations = _nearest_orthogonal(at_rest[:, :3, :3])
    return Skeleton(positions, np.array(parents), names, orientations=orientations)  # type: ignore[arg-type]


def _nearest_orthogonal(linear: NDArray) -> NDArray:
    """Take scale and shear out of matrices (j, 3, 3): the orthogonal factor of each."""
    left, _, right = np.linalg.svd(np.nan_to_num(linear))
    return left @ right


def unique_names(names: list) -> tuple[str, ...]:
    """Name the unnamed after their number and number those that are named alike."""
    originals = [n if isinstance(n, str) and n else f"joint {i}" for i, n in enumerate(names)]
    reserved = set(originals)
    assigned: set[str] = set()
    numbers: dict[str, int] = {}
    unique = []
    for name in originals:
        candidate = name
        while candidate in assigned or (candidate != name and candidate in reserved):
            numbers[name] = numbers.get(name, 1) + 1
            candidate = f"{name} ({numbers[name]})"
        assigned.add(candidate)
        unique.append(candidate)
    return tuple(unique)
