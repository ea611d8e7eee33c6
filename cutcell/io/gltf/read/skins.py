"""From glTF skins to one skeleton in one space.

The space is the bind space of the first skin: there vertices have the positions of their accessor.
A joint's rest position is where its inverse bind matrix comes from, inverse(IBM) · 0. If the
matrix contradicts the joint's node, `read_skins` has replaced it.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from ....errors import FileError, SkeletonError
from ....rig import Skeleton
from ..binds import agreed, invertible
from ..container import Document
from ..nodes import Nodes
from .stored_skins import mended_warning, read_skins


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
    stays: dict[int, NDArray] = field(default_factory=dict)
    """Places of joints that stay where a matrix was that was replaced."""
    mended: dict[int, dict[int, NDArray]] = field(default_factory=dict)
    """Of each skin, by the joint's number in it: matrices that replace those of the file."""


def read_bind(
    document: Document, nodes: Nodes, skins: list[int], world: NDArray | None = None
) -> Bind:
    """Bring the skins of a file together; the first one sets the space.

    `world` leads from there to the scene; the joints at rest say where it is when left out.
    """
    bind = Bind()
    stored = read_skins(document, nodes, skins)
    place: dict[int, int] = {}
    mended: set[int] = set()
    votes: list[tuple[NDArray, NDArray]] = []
    for skin, one in stored.items():
        shared = [
            k
            for k, node in enumerate(one.nodes)
            if node in place and place[node] not in mended and not one.bound.mended[k]
        ]
        is_first = not bind.nodes
        if is_first:
            to_rig = np.eye(4)
        elif shared:
            here = np.array([bind.inverse[place[one.nodes[k]]] for k in shared])
            shares = one.bound.shares[shared]
            relations = np.linalg.inv(here) @ one.bound.inverse[shared]
            shares = shares if shares.any() else np.ones(len(shared))
            to_rig = agreed(relations, shares, one.bound.corners)
        else:
            to_rig = np.linalg.inv(bind.world) @ one.stands([one.votes(np.eye(4))])
        if not invertible(to_rig):
            raise SkeletonError(
                f"{document.label('skins', skin)}: its inverse bind matrices cannot be inverted"
            )
        moved = one.bound.inverse @ np.linalg.inv(to_rig)
        for k, node in enumerate(one.nodes):
            if node not in place:
                place[node] = len(bind.nodes)
                bind.nodes.append(node)
                bind.inverse.append(moved[k])
                if one.bound.mended[k]:
                    mended.add(place[node])
                if k in one.bound.stays:
                    stays = to_rig @ [*one.bound.stays[k], 1.0]
                    bind.stays[place[node]] = stays[:3]
                if not one.has_binds and len(one.nodes) > 1:
                    bind.unbound.add(place[node])
            elif place[node] in mended and not one.bound.mended[k]:
                mended.remove(place[node])
                bind.stays.pop(place[node], None)
                bind.inverse[place[node]] = moved[k]
        bind.skins[skin] = [place[node] for node in one.nodes]
        bind.to_rig[skin] = to_rig
        if is_first or shared:
            votes.append(one.votes(to_rig))
            bind.world = stored[skins[0]].stands(votes) if world is None else world
    for skin, one in stored.items():
        bind.mended[skin] = {
            k: bind.inverse[bind.skins[skin][k]] @ bind.to_rig[skin]
            for k in np.flatnonzero(one.bound.mended).tolist()
        }
    if mended - set(bind.stays):
        names = _names(nodes, bind)
        placed = sorted(mended - set(bind.stays))
        document.warnings.append(mended_warning([names[j] for j in placed]))
    return bind


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
    for j, place_of_joint in bind.stays.items():
        positions[j] = place_of_joint
    if not np.isfinite(positions).all():
        raise FileError("a joint has no finite rest position")
    names = _names(nodes, bind)
    orientations = _nearest_orthogonal(at_rest[:, :3, :3])
    return Skeleton(positions, np.array(parents), names, orientations=orientations)  # type: ignore[arg-type]


def _names(nodes: Nodes, bind: Bind) -> tuple[str, ...]:
    return unique_names([nodes.raw[node].get("name") for node in bind.nodes])


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
