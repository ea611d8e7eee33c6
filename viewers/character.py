"""The parts of a rig as actors: the body, its attachments, and its bones."""

from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from cutcell.geometry.triangles import normals
from cutcell.geometry.welded import WeldedMesh
from cutcell.graph import Lattice
from cutcell.rig import Rig, TriangleMesh

from .description import Actor
from .palette import ATTACHMENT, BODY, BONE, BONE_CHOSEN, BONE_EDGE, BONE_IDLE, to_bytes
from .skin import Skin

CREASE = np.cos(np.radians(45))
"""Faces that meet at a sharper angle than this keep their edge."""
OUTLINE = 0.0009
"""Thickness of a bone's outline, relative to the diagonal of the character's box."""
MAX_AT_A_PLACE = 64
"""Vertices at one place that share a normal; a larger heap is no smooth surface, and slow."""
OCTAHEDRON = np.array(
    [[0, 2, 1], [0, 3, 2], [0, 4, 3], [0, 1, 4], [5, 1, 2], [5, 2, 3], [5, 3, 4], [5, 4, 1]]
)


def to_scene(rig: Rig, points: ArrayLike) -> NDArray[np.float64]:
    """Take points (n, 3) from the rig's space to the scene's, where y is up."""
    return np.asarray(points, float) @ rig.world[:3, :3].T + rig.world[:3, 3]


def from_scene(rig: Rig, points: NDArray[np.float64]) -> NDArray[np.float64]:
    """Take points (n, 3) from the scene's space to the rig's."""
    return np.asarray(np.linalg.solve(rig.world[:3, :3], (points - rig.world[:3, 3]).T).T, float)


def lattice_to_scene(rig: Rig, lattice: Lattice, points: ArrayLike) -> NDArray[np.float64]:
    """Take points (n, 3) from a lattice's unit cube to the scene's space."""
    return to_scene(rig, lattice.to_file(points))


def cell_length(rig: Rig, lattice: Lattice) -> float:
    """Return the length of a lattice's cell in the scene."""
    return lattice.size / lattice.resolution * float(np.linalg.norm(rig.world[:3, 0]))


def in_scene(rig: Rig, mesh: TriangleMesh) -> TriangleMesh:
    """Return a mesh of the rig in the scene's space, still facing the same way."""
    is_mirrored = np.linalg.det(rig.world[:3, :3]) < 0
    faces = mesh.faces[:, ::-1] if is_mirrored else mesh.faces
    return TriangleMesh(to_scene(rig, mesh.vertices), faces)


def pose_in_scene(rig: Rig, transforms: ArrayLike) -> NDArray[np.float64]:
    """Take skinning matrices (..., 4, 4) from the rig's space to the scene's."""
    return rig.world @ np.asarray(transforms, float) @ np.linalg.inv(rig.world)


def diagonal(rig: Rig) -> float:
    """Return the diagonal of the character's box in the scene."""
    return float(np.linalg.norm(np.ptp(to_scene(rig, rig.mesh.vertices), axis=0)))


def character(
    rig: Rig,
    weights: ArrayLike | None = None,
    chosen: int | None = None,
    skeleton: bool = True,
    bone_colors: ArrayLike | None = None,
    **style: Any,
) -> dict[str, Actor]:
    """Return the actors "body", "bones", "bone outlines", "attachment 0", "attachment 1", ...

    Parameters
    ----------
    rig : Rig
    weights, **style
        Of the `body`.
    chosen, skeleton, bone_colors
        Of the `bones`: which are highlighted, whether they are visible, and their colours.
    """
    return {
        "body": body(rig, weights, **style),
        **attachments(rig),
        **bones(rig, chosen, skeleton, bone_colors),
    }


def body(rig: Rig, weights: ArrayLike | None = None, **style: Any) -> Actor:
    """Return the rig's mesh as an actor.

    Parameters
    ----------
    rig : Rig
    weights : array_like, shape (n, j), optional
        The file's own by default.
    **style
        Other fields of `Actor`: `colors`, `scalars`, `opacity`, ...
    """
    weights = rig.weights if weights is None else weights
    skin = None if weights is None else Skin.of_weights(weights)
    return _surface(rig, rig.mesh, skin, **{"color": BODY, **style})


def attachments(rig: Rig, **style: Any) -> dict[str, Actor]:
    """Return an actor for each attachment, which follows its joint rigidly."""
    skins = [Skin.rigid(np.full(len(one.mesh.vertices), one.joint)) for one in rig.attachments]
    return {
        f"attachment {i}": _surface(rig, one.mesh, skin, **{"color": ATTACHMENT, **style})
        for i, (one, skin) in enumerate(zip(rig.attachments, skins, strict=True))
    }


def bones(
    rig: Rig,
    chosen: int | None = None,
    visible: bool = True,
    colors: ArrayLike | None = None,
    shown: ArrayLike | None = None,
) -> dict[str, Actor]:
    """Return the actors "bones", octahedra drawn over everything, and "bone outlines".

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
        The bones of `drawn_segments` that there are; all by default.
    """
    start, end, joint = drawn_segments(rig)
    if shown is not None:
        start, end, joint = (values[np.asarray(shown, bool)] for values in (start, end, joint))
    size, deform = diagonal(rig), rig.skeleton.deform[joint]
    is_chosen = joint == chosen
    color = np.where(
        deform[:, None], BONE if colors is None else np.asarray(colors)[joint], BONE_IDLE
    )
    edge = np.tile(BONE_EDGE, (len(joint), 1))
    (color if colors is None else edge)[is_chosen] = BONE_CHOSEN
    thick = np.where(is_chosen & (colors is not None), 3.0, 1.0) * OUTLINE * size
    return {
        name: Actor.solid(
            _octahedra(start, end, size, deform, wider).reshape(-1, 3),
            (OCTAHEDRON + 6 * np.arange(len(joint))[:, None, None]).reshape(-1, 3),
            colors=np.repeat(to_bytes(shade), 6, axis=0),
            skin=Skin.rigid(np.repeat(joint, 6)),
            hull=name != "bones",
            overlay=True,
            visible=visible,
        )
        for name, shade, wider in (
            ("bones", color, np.zeros(len(joint))),
            ("bone outlines", edge, thick),
        )
    }


def drawn_segments(
    rig: Rig,
) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.intp]]:
    """Return the bones as they are drawn and clicked.

    A joint without children gets a short stub along its parent's direction, to be clicked.

    Returns
    -------
    start, end : array, shape (b, 3)
        In the scene's space. None for a mesh without a skeleton.
    joint : array, shape (b,)
        The joint that each bone belongs to and moves with.
    """
    skeleton, size = rig.skeleton, diagonal(rig)
    joints = to_scene(rig, skeleton.joints)
    parents = np.asarray(skeleton.parents)
    child = np.flatnonzero(parents >= 0)
    child = child[np.argsort(parents[child], kind="stable")]
    leaf = np.setdiff1d(np.arange(len(joints)), parents)
    along = np.where(parents[leaf, None] >= 0, joints[leaf] - joints[parents[leaf]], [0.0, 1, 0])
    along, length = unit_vectors(along)
    stub = along * np.clip(0.4 * np.where(length > 0, length, 1), 0.006 * size, 0.03 * size)
    joint = np.concatenate([parents[child], leaf])
    return joints[joint], np.concatenate([joints[child], joints[leaf] + stub]), joint


def bone_frames(
    start: NDArray[np.float64], end: NDArray[np.float64]
) -> tuple[NDArray[np.float64], ...]:
    """Return the lengths (n, 1) of segments, and three unit vectors (n, 3), the first along them.

    Segments without length point up.
    """
    along, length = unit_vectors(end - start)
    helper = np.where(np.abs(along[:, 1:2]) < 0.9, [0.0, 1, 0], [1.0, 0, 0])
    side = np.cross(along, helper)
    side /= np.linalg.norm(side, axis=1, keepdims=True)
    return length, along, side, np.cross(along, side)


def _octahedra(
    start: NDArray, end: NDArray, size: float, deform: NDArray[np.bool_], wider: NDArray
) -> NDArray[np.float64]:
    length, along, side, other = bone_frames(start, end)
    # Bones that move nothing are thin: some reach far out of the body.
    most = np.where(deform[:, None], 0.0105, 0.003) * size
    radius = np.clip(0.085 * length, 0.0025 * size, most)
    ring = start + along * np.minimum(0.14 * length, 1.5 * radius)
    wide = radius + 1.4 * wider[:, None]
    around = [ring + wide * d for d in (side, other, -side, -other)]
    overhang = 2 * wider[:, None] * along
    return np.stack([start - overhang, *around, end + 2 * overhang], axis=1)


def _surface(rig: Rig, mesh: TriangleMesh, skin: Skin | None, **style: Any) -> Actor:
    placed = in_scene(rig, mesh)
    points, faces = placed.vertices, placed.faces
    return Actor(
        "surface",
        points,
        faces,
        normals=smooth_normals(points, faces, mesh.welded.index),
        skin=skin,
        closed=is_closed(mesh.welded),
        **style,
    )


def is_closed(mesh: WeldedMesh) -> bool:
    """Return whether a mesh encloses a volume: no border, and every part faces outwards."""
    if not mesh.is_closed or not mesh.is_whole.any():
        return False
    faces = mesh.faces[mesh.is_whole]
    part, (a, b, c) = mesh.component[faces[:, 0]], mesh.points[faces].transpose(1, 0, 2)
    volumes = np.bincount(part, np.einsum("fi,fi->f", a, np.cross(b, c)))
    return bool((volumes[np.unique(part)] > 0).all())


def smooth_normals(
    points: NDArray[np.float64], faces: NDArray, index: NDArray[np.int32]
) -> NDArray[np.float64]:
    """Return unit normals (n, 3) that are smooth over seams and sharp over creases.

    Vertices that are welded to one, `index` (n,), share their normals where these differ by less
    than 45 degrees: exporters split vertices at texture seams as well as at hard edges.
    """
    area = normals(points[faces])
    face_sum = np.zeros_like(points)
    for k in range(3):
        np.add.at(face_sum, faces[:, k], area)
    unit = face_sum / np.maximum(np.linalg.norm(face_sum, axis=1, keepdims=True), 1e-300)
    order = np.argsort(index, kind="stable")
    group = index[order]
    total = face_sum.copy()
    for shift in range(1, min(int(np.bincount(group).max()), MAX_AT_A_PLACE)):
        a, b = order[:-shift], order[shift:]
        near = (group[:-shift] == group[shift:]) & ((unit[a] * unit[b]).sum(axis=1) > CREASE)
        np.add.at(total, a[near], face_sum[b[near]])
        np.add.at(total, b[near], face_sum[a[near]])
    return unit_vectors(total)[0]


def unit_vectors(vectors: NDArray[np.float64]) -> tuple[NDArray, NDArray]:
    """Return unit vectors (n, 3), which point up where the length is zero, and lengths (n, 1)."""
    length = np.linalg.norm(vectors, axis=1, keepdims=True)
    return np.where(length > 0, vectors / np.where(length > 0, length, 1), [0.0, 1, 0]), length
