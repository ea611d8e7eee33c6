"""The parts of a rig as actors: the body, its attachments, and its bones."""

from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import connected_components

from cutcell.geometry.triangles import normals
from cutcell.rig import Rig, Skeleton, TriangleMesh

from .description import Actor
from .palette import ATTACHMENT, BODY, BONE, BONE_CHOSEN, BONE_EDGE, BONE_IDLE, to_bytes
from .skin import Skin, rigid_skin, skin_of_weights

CREASE = np.cos(np.radians(45))
"""Faces that meet at a sharper angle than this keep their edge."""
OUTLINE = 0.0009
"""Thickness of a bone's outline, relative to the diagonal of the character's box."""

MAX_AT_A_PLACE = 64
"""Vertices that share a normal; a heap of more is no smooth surface, and would take for ever."""


def to_scene(rig: Rig, points: ArrayLike) -> NDArray[np.float64]:
    """Take points (n, 3) from the rig's space to the scene's, where y is up."""
    return np.asarray(points, float) @ rig.world[:3, :3].T + rig.world[:3, 3]


def pose_in_scene(rig: Rig, transforms: ArrayLike) -> NDArray[np.float64]:
    """Take skinning matrices (..., 4, 4) from the rig's space to the scene's."""
    return rig.world @ np.asarray(transforms, float) @ np.linalg.inv(rig.world)


def body(rig: Rig, weights: ArrayLike | None = None, **style: Any) -> Actor:
    """Return the rig's mesh as an actor.

    Parameters
    ----------
    rig : Rig
    weights : array_like, shape (n, j), optional
        How the body follows the joints; the file's own when left out.
    **look
        Other fields of `Actor`: `colors`, `scalars`, `opacity`, ...
    """
    weights = rig.weights if weights is None else weights
    skin = None if weights is None else skin_of_weights(weights)
    return _surface(rig, rig.mesh, skin, **{"color": BODY, **style})


def attachments(rig: Rig, **style: Any) -> dict[str, Actor]:
    """Return what hangs rigidly on joints, one actor each."""
    return {
        f"attachment {i}": _surface(
            rig,
            one.mesh,
            rigid_skin(np.full(len(one.mesh.vertices), one.joint)),
            **{"color": ATTACHMENT, **style},
        )
        for i, one in enumerate(rig.attachments)
    }


def bones(
    rig: Rig,
    chosen: int | None = None,
    visible: bool = True,
    colors: ArrayLike | None = None,
    shown: ArrayLike | None = None,
) -> dict[str, Actor]:
    """Return the skeleton, one octahedron a bone with an outline, drawn over everything.

    Parameters
    ----------
    rig : Rig
    chosen : int, optional
        The joint whose bones are highlighted.
    visible : bool
    colors : array_like, shape (j, 3), optional
        The colour of the bones of each deforming joint; the chosen one then differs
        by its outline.
    shown : array_like, shape (b,), bool, optional
        Which of the bones of `drawn_segments` there are; all when left out.

    Returns
    -------
    dict
        The actors "bones" and "bone outlines".
    """
    start, end, joint = drawn_segments(rig)
    if shown is not None:
        visible_bones = np.asarray(shown, bool)
        start, end, joint = start[visible_bones], end[visible_bones], joint[visible_bones]
    size = float(np.linalg.norm(np.ptp(to_scene(rig, rig.mesh.vertices), axis=0)))
    of_chosen = joint == chosen
    edge = np.where(of_chosen[:, None] & (colors is not None), BONE_CHOSEN, BONE_EDGE)
    if colors is None:
        color = np.where(rig.skeleton.deform[joint, None], BONE, BONE_IDLE)
        color[of_chosen] = BONE_CHOSEN
    else:
        color = np.where(rig.skeleton.deform[joint, None], np.asarray(colors)[joint], BONE_IDLE)
    thick = np.where(of_chosen & (colors is not None), 3.0, 1.0) * OUTLINE * size
    common: dict[str, Any] = {
        "cells": (_OCTAHEDRON + 6 * np.arange(len(joint))[:, None, None]).reshape(-1, 3),
        "skin": rigid_skin(np.repeat(joint, 6)),
        "overlay": True,
        "clipped": False,
        "visible": visible,
    }
    common["cells"] = common["cells"].astype(np.int32)
    return {
        name: Actor(
            "surface",
            _octahedra(start, end, size, rig.skeleton.deform[joint], wider)
            .reshape(-1, 3)
            .astype(np.float32),
            colors=np.repeat(to_bytes(color_of), 6, axis=0),
            hull=name != "bones",
            **common,
        )
        for name, color_of, wider in (
            ("bones", color, np.zeros(len(joint))),
            ("bone outlines", edge, thick),
        )
    }


def drawn_segments(
    rig: Rig,
) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.intp]]:
    """Return the bones as they are drawn and clicked.

    A joint without children gets a short stub along its parent's direction, to have
    something to click on.

    Returns
    -------
    start, end : array, shape (b, 3)
        In the scene's space. None for a mesh without a skeleton.
    joint : array, shape (b,)
        The joint that each bone belongs to and moves with.
    """
    skeleton = rig.skeleton
    joints = to_scene(rig, skeleton.joints)
    size = float(np.linalg.norm(np.ptp(to_scene(rig, rig.mesh.vertices), axis=0)))
    pairs = [(joints[j], joints[c], j) for j, cs in enumerate(skeleton.children) for c in cs]
    for j in range(len(joints)):
        if not len(skeleton.children[j]):
            pairs.append((joints[j], joints[j] + _stub(skeleton, joints, j, size), j))
    start, end, joint = zip(*pairs, strict=True) if pairs else ((), (), ())
    shape = (-1, 3)
    return np.reshape(start, shape), np.reshape(end, shape), np.array(joint, np.intp)


def _stub(skeleton: Skeleton, joints: NDArray, j: int, size: float) -> NDArray[np.float64]:
    parent = skeleton.parents[j]
    along = joints[j] - joints[parent] if parent >= 0 else np.array([0.0, 1, 0])
    length = float(np.linalg.norm(along))
    if length == 0:
        along, length = np.array([0.0, 1, 0]), 1.0
    return along / length * np.clip(0.4 * length, 0.006 * size, 0.03 * size)


_OCTAHEDRON = np.array(
    [[0, 2, 1], [0, 3, 2], [0, 4, 3], [0, 1, 4], [5, 1, 2], [5, 2, 3], [5, 3, 4], [5, 4, 1]]
)


def across(along: NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return two unit vectors (n, 3) at right angles to others and to each other."""
    helper = np.where(np.abs(along[:, 1:2]) < 0.9, [0.0, 1, 0], [1.0, 0, 0])
    side = np.cross(along, helper)
    side /= np.linalg.norm(side, axis=1, keepdims=True)
    return side, np.cross(along, side)


def _octahedra(
    start: NDArray, end: NDArray, size: float, deform: NDArray[np.bool_], wider: NDArray
) -> NDArray[np.float64]:
    along = end - start
    length = np.linalg.norm(along, axis=1, keepdims=True)
    along = np.where(length > 0, along / np.where(length > 0, length, 1), [0.0, 1, 0])
    side, other = across(along)
    # Bones that move nothing are thin: some reach far out of the body.
    most = np.where(deform[:, None], 0.0105, 0.003) * size
    radius = np.clip(0.085 * length, 0.0025 * size, most)
    ring = start + along * np.minimum(0.14 * length, 1.5 * radius)
    wide = radius + 1.4 * wider[:, None]
    around = [ring + wide * d for d in (side, other, -side, -other)]
    more = 2 * wider[:, None] * along
    return np.stack([start - more, *around, end + 2 * more], axis=1)


def _surface(rig: Rig, mesh: TriangleMesh, skin: Skin | None, **style: Any) -> Actor:
    points = to_scene(rig, mesh.vertices)
    # A mirrored space turns faces inside out; for looking, turn them back.
    faces = mesh.faces if np.linalg.det(rig.world[:3, :3]) > 0 else mesh.faces[:, ::-1]
    return Actor(
        "surface",
        points.astype(np.float32),
        faces.astype(np.int32),
        normals=smooth_normals(points, faces).astype(np.float32),
        skin=skin,
        closed=is_closed(points, faces),
        **style,
    )


def is_closed(points: NDArray[np.float64], faces: NDArray) -> bool:
    """Whether faces enclose what is behind them: no border, and every part faces outwards.

    Vertices at the same place are one.

    Parameters
    ----------
    points : array, shape (n, 3)
    faces : array, shape (m, 3)
    """
    place = _places(points)
    corners = place[faces]
    whole = (corners != np.roll(corners, 1, axis=1)).all(axis=1)
    corners, count = corners[whole], int(place.max(initial=0)) + 1
    a, b = corners.ravel(), np.roll(corners, -1, axis=1).ravel()
    # Each edge is run along as often one way as the other.
    if not len(corners) or not np.array_equal(np.sort(a * count + b), np.sort(b * count + a)):
        return False
    _, part = connected_components(coo_matrix((np.ones(len(a)), (a, b)), (count, count)))
    three = points[faces[whole]]
    volume = np.einsum("fi,fi->f", three[:, 0], np.cross(three[:, 1], three[:, 2]))
    volumes = np.bincount(part[corners[:, 0]], volume)
    return bool((volumes[np.unique(part[corners])] > 0).all())


def _places(points: NDArray[np.float64]) -> NDArray[np.intp]:
    """Return the number of the place that each of the points (n, 3) is at."""
    if not len(points):
        return np.zeros(0, np.intp)
    # Not by np.unique, which keeps Python's lock, and all other threads waiting, as it sorts rows.
    order = np.lexsort(points.T)
    ordered = points[order]
    new = np.concatenate([[False], (ordered[1:] != ordered[:-1]).any(axis=1)])
    place = np.empty(len(points), np.intp)
    place[order] = np.cumsum(new)
    return place


def smooth_normals(points: NDArray[np.float64], faces: NDArray) -> NDArray[np.float64]:
    """Return unit normals (n, 3) that are smooth over seams and sharp over creases.

    Vertices at the same place share their normals where these differ by less than 45
    degrees: exporters split vertices at texture seams as well as at hard edges.
    """
    area = normals(points[faces])
    face_sum = np.zeros_like(points)
    for k in range(3):
        np.add.at(face_sum, faces[:, k], area)
    unit = face_sum / np.maximum(np.linalg.norm(face_sum, axis=1, keepdims=True), 1e-300)
    group = _places(points)
    order = np.argsort(group, kind="stable")
    group = group[order]
    total = face_sum.copy()
    for shift in range(1, min(int(np.bincount(group).max()), MAX_AT_A_PLACE)):
        a, b = order[:-shift], order[shift:]
        near = (group[:-shift] == group[shift:]) & ((unit[a] * unit[b]).sum(axis=1) > CREASE)
        np.add.at(total, a[near], face_sum[b[near]])
        np.add.at(total, b[near], face_sum[a[near]])
    length = np.linalg.norm(total, axis=1, keepdims=True)
    return np.where(length > 0, total / np.where(length > 0, length, 1), [0.0, 1, 0])
