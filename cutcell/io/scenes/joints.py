"""Which nodes of a scene are the joints of which mesh, and how each was bound."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..gltf.binds import BoundSkin, mend
from ..gltf.nodes import compose


@dataclass(frozen=True, eq=False)
class SceneSkin:
    """The joints of a mesh, as nodes, and their inverse bind matrices, shape (j, 4, 4)."""

    joints: list[int]
    inverse: NDArray[np.float64]
    mended: tuple[int, ...] = ()
    """Joints, as nodes, that are placed by their nodes since their matrix contradicts them."""


def scene_skins(scene: Mapping[str, NDArray]) -> tuple[dict[int, SceneSkin], NDArray | None]:
    """Return the skin of each mesh that has one, and the matrix of the first such mesh.

    A skin names the joints that hold a vertex. The other bones of the same tree (fingertips,
    roots, helpers) join the first mesh that is bound to it, where they are at rest relative to
    the nearest bone above that it knows. In a scene without any weights each mesh that is
    below no bone, or each if all are below one, is bound to all bones in their current position.
    """
    parents = scene["node_parents"].tolist()
    world = _worlds(scene["node_transforms"], parents)
    bones = np.flatnonzero(scene["node_bones"]).tolist()
    meshes = range(len(scene["mesh_names"]))
    skins = {
        k: SceneSkin(scene[f"mesh_{k}_joints"].tolist(), scene[f"mesh_{k}_inverse"])
        for k in meshes
        if f"mesh_{k}_joints" in scene and len(scene[f"mesh_{k}_joints"])
    }
    skins = _mended(scene, skins, parents, world) or _unbound(scene, parents, world, bones)
    if not skins:
        return {}, None
    first = min(skins)  # its joints may be posed
    stands = world[int(scene["mesh_nodes"][first])] @ scene[f"mesh_{first}_place"]
    assigned: set[int] = {joint for skin in skins.values() for joint in skin.joints}
    for k, skin in list(skins.items()):
        trees = {_above(joint, parents)[-1] for joint in skin.joints}
        more = [b for b in bones if b not in assigned and _above(b, parents)[-1] in trees]
        skins[k] = _with_more(skin, more, parents, world)
        assigned.update(more)
    return skins, stands if _inverse(stands)[1] else None


def _worlds(transforms: NDArray, parents: list[int]) -> NDArray:
    world = compose(transforms[:, :3], transforms[:, 3:7], transforms[:, 7:])
    for i, parent in enumerate(parents):  # parents come before their children
        if parent >= 0:
            world[i] = world[parent] @ world[i]
    return world


def _above(node: int, parents: list[int]) -> list[int]:
    """Return a node and those above it, without the scene's root."""
    chain = [node]
    while parents[node] > 0:
        chain.append(node := parents[node])
    return chain


def _with_more(skin: SceneSkin, more: list[int], parents: list[int], world: NDArray) -> SceneSkin:
    place = {joint: k for k, joint in enumerate(skin.joints)}
    added = []
    for bone in more:
        ancestor = next((a for a in _above(bone, parents) if a in place), skin.joints[0])
        inverse, solvable = _inverse(world[bone])
        if solvable:
            added.append((bone, inverse @ world[ancestor] @ skin.inverse[place[ancestor]]))
    return SceneSkin(
        [*skin.joints, *(bone for bone, _ in added)],
        np.concatenate([skin.inverse, np.array([m for _, m in added]).reshape(-1, 4, 4)]),
        skin.mended,
    )


def _mended(
    scene: Mapping[str, NDArray], skins: dict[int, SceneSkin], parents: list[int], world: NDArray
) -> dict[int, SceneSkin]:
    """Return skins without matrices that contradict the nodes of joints that hold no vertex."""
    bound = {}
    for k, skin in skins.items():
        arrays = world[skin.joints], scene[f"mesh_{k}_place"], scene[f"mesh_{k}_vertices"]
        is_regular = len(arrays[2]) > 0 and all(np.isfinite(one).all() for one in arrays)
        if is_regular and _inverse(arrays[1])[1]:
            bound[k] = _bound(scene, k, skin, parents, world)
    mend(list(bound.values()))
    mended = dict(skins)
    for k, one in bound.items():
        skin, inverse = skins[k], skins[k].inverse.copy()
        at = [j for j in np.flatnonzero(one.mended).tolist() if j not in one.stays]
        inverse[at] = one.inverse[at] @ scene[f"mesh_{k}_place"]
        mended[k] = SceneSkin(skin.joints, inverse, tuple(skin.joints[j] for j in at))
    return mended


def _bound(
    scene: Mapping[str, NDArray], k: int, skin: SceneSkin, parents: list[int], world: NDArray
) -> BoundSkin:
    """Return a mesh's skin in the space in which its joints were bound."""
    place, vertices = scene[f"mesh_{k}_place"], scene[f"mesh_{k}_vertices"]
    number = {joint: j for j, joint in enumerate(skin.joints)} | {-1: -1}
    above = [
        next((a for a in _above(joint, parents)[1:] if a in number), -1) for joint in skin.joints
    ]
    relative = [
        _inverse(world[a])[0] @ world[joint] if a >= 0 else world[joint]
        for joint, a in zip(skin.joints, above, strict=True)
    ]
    columns = scene.get(f"mesh_{k}_columns", np.zeros(0, int))
    values = scene.get(f"mesh_{k}_values", np.zeros(0))
    used = np.isfinite(values) & (values > 0) & (columns >= 0) & (columns < len(skin.joints))
    points = vertices @ place[:3, :3].T + place[:3, 3]
    return BoundSkin(
        skin.inverse @ _inverse(place)[0],
        np.bincount(columns[used], np.minimum(values[used], 1.0), len(skin.joints)).astype(float),
        world[skin.joints],
        np.array(relative),
        [number[a] for a in above],
        np.argsort(skin.joints, kind="stable").tolist(),  # parents come before their children
        np.array([points.min(axis=0), points.max(axis=0)]),
        skin.joints,
    )


def _unbound(
    scene: Mapping[str, NDArray], parents: list[int], world: NDArray, bones: list[int]
) -> dict[int, SceneSkin]:
    inverses = [(bone, *_inverse(world[bone])) for bone in bones]
    able = [(bone, inverse) for bone, inverse, solvable in inverses if solvable]
    places = scene["mesh_nodes"].tolist()
    free = [k for k, node in enumerate(places) if not set(_above(node, parents)) & set(bones)]
    skins = {}
    for k in (free or range(len(places))) if able else ():
        place = world[places[k]] @ scene[f"mesh_{k}_place"]
        inverse = np.array([matrix @ place for _, matrix in able])
        skins[k] = SceneSkin([bone for bone, _ in able], inverse)
    return skins


def _inverse(matrix: NDArray) -> tuple[NDArray, bool]:
    solvable = np.isfinite(matrix).all() and abs(np.linalg.det(matrix)) > 1e-300
    return (np.linalg.inv(matrix) if solvable else matrix), bool(solvable)
