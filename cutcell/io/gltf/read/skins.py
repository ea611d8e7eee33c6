"""The skins of a glTF document: their joints, inverse bind matrices and vertices."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from ....errors import FileError, SkeletonError
from ....rig import Skeleton
from ..binds import BoundSkin, agreed, invertible, mend, rest_world
from ..container import Document, indices
from ..nodes import Nodes
from .accessors import read_accessor
from .primitives import drawn_primitives


def _votes(skin: BoundSkin, to_rig: NDArray) -> tuple[NDArray, NDArray]:
    """Return where trusted joints say that the rig stands, (k, 4, 4), and their shares (k,)."""
    at = skin.trusted() if skin.has_binds else []
    return skin.skinning[at] @ np.linalg.inv(to_rig), skin.votes(at)


def _stands(skin: BoundSkin, votes: Sequence[tuple[NDArray, NDArray]]) -> NDArray[np.float64]:
    """Return the matrix from a skin's bind space to the scene, by the votes of some skins."""
    matrices, shares = (np.concatenate(arrays) for arrays in zip(*votes, strict=True))
    k = skin.topmost()
    topmost = None if k is None else skin.skinning[k]
    if len(shares):
        is_control = k is not None and not skin.is_held[k]
        return rest_world(matrices, shares, topmost, is_control, skin.corners)
    return np.eye(4) if topmost is None else topmost


def read_skins(document: Document, nodes: Nodes, skins: list[int]) -> dict[int, BoundSkin]:
    """Return skins, with other matrices where those of the file contradict the nodes."""
    in_scene = set(nodes.in_scene())
    stored = {}
    with np.errstate(over="ignore", invalid="ignore", divide="ignore"):
        for skin in skins:
            users = [i for i, n in enumerate(nodes.raw) if n.get("skin") == skin and "mesh" in n]
            users = [i for i in users if i in in_scene] or users
            stored[skin] = _read_skin(document, nodes, skin, users)
        mend([one for one in stored.values() if one.has_binds])
    for skin, one in stored.items():
        bad = np.flatnonzero(~invertible(one.inverse))
        if len(bad):
            raise SkeletonError(
                f"{document.label('skins', skin)}: the inverse bind matrix of the joint "
                f"{document.label('nodes', one.nodes[bad[0]])} cannot be inverted"
            )
    return stored


def mended_warning(names: list[str]) -> str:
    """Return the sentence about joints whose matrices were replaced, by their names."""
    joints = f'{len(names):,} joints (the first is "{names[0]}") are'
    if len(names) == 1:
        joints = f'the joint "{names[0]}" is'
    return (
        f"{joints} placed by nodes: inverse bind matrices are missing, or contradict the nodes and "
        "move no vertex"
    )


def _read_skin(document: Document, nodes: Nodes, skin: int, users: list[int]) -> BoundSkin:
    joints = _skin_joints(document, skin)
    inverse, has_binds = _inverse_binds(document, skin, joints)
    shares, corners = _vertices(document, nodes, users, len(joints))
    nearest = [*nodes.nearest(set(joints)), -1]  # the last is above roots
    number = {node: k for k, node in enumerate(joints)} | {-1: -1}
    above = [nodes.parents[node] for node in joints]
    relative = np.concatenate([nodes.relative_to(joints), np.eye(4)[None]])
    relative, world = relative[above] @ nodes.local[joints], nodes.world[joints]
    parents = [number[nearest[node]] for node in above]
    order = np.argsort(nodes.depth[joints], kind="stable").tolist()
    return BoundSkin(inverse, shares, world, relative, parents, order, corners, joints, has_binds)


def _vertices(
    document: Document, nodes: Nodes, users: list[int], joints: int
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return the sum of weights on each joint, (j,), and the corners of a box, (2, 3)."""
    shares = np.zeros(joints)
    corners = np.array([np.full(3, np.inf), np.full(3, -np.inf)])
    for i in users:
        mesh, user = nodes.raw[i]["mesh"], document.label("nodes", i)
        for primitive in drawn_primitives(document, mesh, user):
            corners[0] = np.minimum(corners[0], primitive.positions.min(axis=0))
            corners[1] = np.maximum(corners[1], primitive.positions.max(axis=0))
            shares += primitive.joint_shares(joints)
    return shares, corners if np.isfinite(corners).all() else np.zeros((2, 3))


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
    same = np.tile(np.eye(4), (len(joints), 1, 1))
    if "inverseBindMatrices" not in owner:
        return same, False
    stored = read_accessor(document, owner["inverseBindMatrices"], "MAT4", user)[: len(joints)]
    inverse = stored.astype(np.float64).reshape(-1, 4, 4).transpose(0, 2, 1).copy()
    is_finite = np.isfinite(inverse).all(axis=(1, 2))
    inverse[is_finite, 3] = [0, 0, 0, 1]  # exporters leave rounding noise here
    # Several joints that all have the identity have no matrices, as far as glTF goes.
    if len(joints) > 1 and np.array_equal(inverse, same[: len(inverse)]):
        return same, False
    return np.concatenate([inverse, np.nan * same[len(inverse) :]]), True


def check_unused(document: Document, bind: Bind) -> None:
    """Refuse damaged skins that no mesh uses: saving moves their joints, too."""
    for skin, owner in enumerate(document.items("skins")):
        if skin not in bind.skins and owner.get("joints"):
            _inverse_binds(document, skin, _skin_joints(document, skin))


@dataclass(eq=False)
class Bind:
    """All joints of a file, and how each skin's vertices get into the rig's space."""

    nodes: list[int] = field(default_factory=list)  # the node of each joint
    inverse: list[NDArray] = field(default_factory=list)  # of each, for the rig's space
    skins: dict[int, list[int]] = field(default_factory=dict)  # the joints of each skin
    to_rig: dict[int, NDArray] = field(default_factory=dict)  # from each skin's bind space
    world: NDArray = field(default_factory=lambda: np.eye(4))  # from the rig to the scene, at rest
    unbound: set[int] = field(default_factory=set)  # joints whose skin has no bind matrices
    stays: dict[int, NDArray] = field(default_factory=dict)  # places, despite a new matrix
    mended: dict[int, dict[int, NDArray]] = field(default_factory=dict)
    """Matrices that replace those of the file, by skin and the joint's number in it."""


def read_bind(
    document: Document, nodes: Nodes, skins: list[int], world: NDArray | None = None
) -> Bind:
    """Bring the skins of a file into the space of the first, which `world` leads to the scene."""
    bind = Bind()
    stored = read_skins(document, nodes, skins)
    place: dict[int, int] = {}
    mended: set[int] = set()
    votes: list[tuple[NDArray, NDArray]] = []
    for skin, one in stored.items():
        shared = [
            k
            for k, node in enumerate(one.nodes)
            if node in place and place[node] not in mended and not one.mended[k]
        ]
        is_first = not bind.nodes
        if is_first:
            to_rig = np.eye(4)
        elif shared:
            inverse = np.array([bind.inverse[place[one.nodes[k]]] for k in shared])
            relations = np.linalg.inv(inverse) @ one.inverse[shared]
            to_rig = agreed(relations, one.votes(shared), one.corners)
        else:
            to_rig = np.linalg.inv(bind.world) @ _stands(one, [_votes(one, np.eye(4))])
        if not invertible(to_rig):
            raise SkeletonError(
                f"{document.label('skins', skin)}: its inverse bind matrices cannot be inverted"
            )
        moved = one.inverse @ np.linalg.inv(to_rig)
        for k, node in enumerate(one.nodes):
            if node not in place:
                place[node] = len(bind.nodes)
                bind.nodes.append(node)
                bind.inverse.append(moved[k])
                if one.mended[k]:
                    mended.add(place[node])
                if k in one.stays:
                    bind.stays[place[node]] = (to_rig @ [*one.stays[k], 1.0])[:3]
                if not one.has_binds and len(one.nodes) > 1:
                    bind.unbound.add(place[node])
            elif place[node] in mended and not one.mended[k]:
                mended.remove(place[node])
                bind.stays.pop(place[node], None)
                bind.inverse[place[node]] = moved[k]
        bind.skins[skin] = [place[node] for node in one.nodes]
        bind.to_rig[skin] = to_rig
        if is_first or shared:
            votes.append(_votes(one, to_rig))
            bind.world = _stands(stored[skins[0]], votes) if world is None else world
    for skin, one in stored.items():
        bind.mended[skin] = {
            k: bind.inverse[bind.skins[skin][k]] @ bind.to_rig[skin]
            for k in np.flatnonzero(one.mended).tolist()
        }
    if placed := sorted(mended - set(bind.stays)):
        names = _names(nodes, bind)
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
        at_rest[list(bind.unbound)] = by_nodes[list(bind.unbound)]
    positions = at_rest[:, :3, 3]
    for j, place_of_joint in bind.stays.items():
        positions[j] = place_of_joint
    if not np.isfinite(positions).all():
        raise FileError("a joint has no finite rest position")
    names = _names(nodes, bind)
    left, _, right = np.linalg.svd(np.nan_to_num(at_rest[:, :3, :3]))  # without scale and shear
    return Skeleton(positions, np.array(parents), names, orientations=left @ right)  # type: ignore[arg-type]


def _names(nodes: Nodes, bind: Bind) -> tuple[str, ...]:
    """Name unnamed joints after their number and number those that are named alike."""
    names = [nodes.raw[node].get("name") for node in bind.nodes]
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
