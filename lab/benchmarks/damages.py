"""Ways to damage a rig, each with the code that a diagnosis must find and where."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import trimesh
from numpy.typing import NDArray
from scipy.spatial import cKDTree

import cutcell
from cutcell import Rig, Skeleton, TriangleMesh
from cutcell.graph import Lattice


@dataclass(frozen=True, eq=False)
class Damaged:
    """A damaged copy of a rig.

    Parameters
    ----------
    rig : Rig
    elements : array of int
        What was damaged: vertices, faces or joints.
    kind : {"vertices", "faces", "joints"}
    """

    rig: Rig
    elements: NDArray[np.intp]
    kind: str


def _with_mesh(rig: Rig, vertices: NDArray, faces: NDArray, rows: NDArray | None = None) -> Rig:
    """Return the rig with another mesh; `rows` says which vertex each new one comes from."""
    weights = rig.weights if rig.weights is None or rows is None else rig.weights[rows]
    mesh = TriangleMesh(vertices, faces)
    plain = replace(rig, mesh=rig.mesh, allowed=None, parts=(), weights=None, source=None)
    return replace(plain, mesh=mesh, weights=weights, weight_sums=None)


def _with_joints(rig: Rig, joints: NDArray, parents: NDArray | None = None) -> Rig:
    skeleton = rig.skeleton
    parents = skeleton.parents if parents is None else parents
    changed = Skeleton(joints, parents, skeleton.names, skeleton.deform)
    return replace(rig, skeleton=changed, source=None, clips=())


def _size(rig: Rig) -> float:
    return float(np.ptp(rig.mesh.bounds, axis=0).max())


def _middles(rig: Rig) -> NDArray[np.float64]:
    return rig.mesh.vertices[rig.mesh.faces].mean(axis=1)


def _around(points: NDArray, count: int, seed: int) -> NDArray[np.intp]:
    """Return the points nearest to one that is drawn."""
    centre = points[np.random.default_rng(seed).integers(len(points))]
    order = np.argsort(np.linalg.norm(points - centre, axis=1), kind="stable")
    return np.sort(order[:count])


def _leaf(rig: Rig) -> int:
    """Return a last joint that carries weight, far from the middle of the skeleton."""
    skeleton = rig.skeleton
    leaves = np.array([not len(c) for c in skeleton.children]) & skeleton.deform
    if not leaves.any():
        leaves = skeleton.deform
    away = np.linalg.norm(skeleton.joints - skeleton.joints[skeleton.deform].mean(axis=0), axis=1)
    return int(np.where(leaves, away, -1).argmax())


def _turned(rig: Rig, which: NDArray) -> Damaged:
    mask = np.zeros(len(rig.mesh.faces), bool)
    mask[which] = True
    faces = np.where(mask[:, None], rig.mesh.faces[:, ::-1], rig.mesh.faces)
    return Damaged(_with_mesh(rig, rig.mesh.vertices, faces), np.flatnonzero(mask), "faces")


def flip_patch(rig: Rig, seed: int) -> Damaged:
    """Turn a fifth of the faces, around one of them, inside out."""
    return _turned(rig, _around(_middles(rig), len(rig.mesh.faces) // 5, seed))


def flip_some(rig: Rig, seed: int) -> Damaged:
    """Turn every third face inside out."""
    return _turned(rig, np.arange(0, len(rig.mesh.faces), 3))


def flip_whole(rig: Rig, seed: int) -> Damaged:
    """Turn the mesh inside out."""
    return _turned(rig, np.arange(len(rig.mesh.faces)))


def delete_faces(rig: Rig, seed: int) -> Damaged:
    """Delete each fortieth face."""
    lost = np.random.default_rng(seed).permutation(len(rig.mesh.faces))
    lost = lost[: max(len(lost) // 40, 20)]
    faces = np.delete(rig.mesh.faces, lost, axis=0)
    return Damaged(
        _with_mesh(rig, rig.mesh.vertices, faces), np.unique(rig.mesh.faces[lost]), "vertices"
    )


def tear_hole(rig: Rig, seed: int) -> Damaged:
    """Delete the faces around one of them."""
    faces = rig.mesh.faces
    lost = _around(_middles(rig), max(len(faces) // 25, 8), seed)
    left = np.delete(faces, lost, axis=0)
    rim = np.intersect1d(faces[lost], left)
    return Damaged(_with_mesh(rig, rig.mesh.vertices, left), rim, "vertices")


def duplicate_faces(rig: Rig, seed: int) -> Damaged:
    """Put a tenth of the faces there once more."""
    faces = rig.mesh.faces
    twice = _around(_middles(rig), len(faces) // 10, seed)
    added = np.arange(len(faces), len(faces) + len(twice))
    return Damaged(
        _with_mesh(rig, rig.mesh.vertices, np.concatenate([faces, faces[twice]])), added, "faces"
    )


def degenerate_faces(rig: Rig, seed: int) -> Damaged:
    """Add faces with a repeated corner."""
    faces = rig.mesh.faces
    flat = faces[:12, [0, 1, 1]]
    added = np.arange(len(faces), len(faces) + len(flat))
    return Damaged(
        _with_mesh(rig, rig.mesh.vertices, np.concatenate([faces, flat])), added, "faces"
    )


def add_fins(rig: Rig, seed: int) -> Damaged:
    """Hang a fin on each of some edges."""
    vertices, faces = rig.mesh.vertices, rig.mesh.faces
    base = faces[_around(_middles(rig), 12, seed)]
    tips = vertices[base].mean(axis=1) + 0.02 * _size(rig)
    numbers = np.arange(len(vertices), len(vertices) + len(tips))
    fins = np.column_stack([base[:, :2], numbers])
    rows = np.concatenate([np.arange(len(vertices)), base[:, 0]])
    damaged = _with_mesh(rig, np.concatenate([vertices, tips]), np.concatenate([faces, fins]), rows)
    return Damaged(damaged, np.arange(len(faces), len(faces) + len(fins)), "faces")


def split_seams(rig: Rig, seed: int) -> Damaged:
    """Give each corner a separate vertex."""
    rows = rig.mesh.faces.ravel()
    faces = np.arange(len(rows)).reshape(-1, 3)
    return Damaged(
        _with_mesh(rig, rig.mesh.vertices[rows], faces, rows), np.arange(len(rows)), "vertices"
    )


def open_crack(rig: Rig, seed: int) -> Damaged:
    """Cut the body across its longest side, and draw the halves a little apart."""
    axis = int(np.ptp(rig.mesh.bounds, axis=0).argmax())
    middle = _middles(rig)[:, axis]
    upper = middle > np.median(middle)
    vertices, faces = rig.mesh.vertices, rig.mesh.faces.copy()
    count = len(vertices)
    faces[upper] += count
    moved = vertices.copy()
    moved[:, axis] += 3e-4 * _size(rig)
    rows = np.tile(np.arange(count), 2)
    place = rig.mesh.welded.index
    both = np.intersect1d(place[rig.mesh.faces[upper]], place[rig.mesh.faces[~upper]])
    cut = np.flatnonzero(np.isin(place, both))
    used = np.unique(faces)
    cut = np.intersect1d(np.concatenate([cut, cut + count]), used)
    return Damaged(_with_mesh(rig, np.concatenate([vertices, moved]), faces, rows), cut, "vertices")


def stray_vertex(rig: Rig, seed: int) -> Damaged:
    """Move a vertex thirty sizes of the body away."""
    vertex = int(rig.mesh.faces[seed % len(rig.mesh.faces), 0])
    vertices = rig.mesh.vertices.copy()
    vertices[vertex] += 30 * _size(rig)
    return Damaged(_with_mesh(rig, vertices, rig.mesh.faces), np.array([vertex]), "vertices")


def add_vertices(rig: Rig, seed: int) -> Damaged:
    """Add vertices that no face uses."""
    vertices = np.concatenate([rig.mesh.vertices, rig.mesh.vertices[:9] + 0.01 * _size(rig)])
    rows = np.concatenate([np.arange(len(rig.mesh.vertices)), np.arange(9)])
    added = np.arange(len(rig.mesh.vertices), len(vertices))
    return Damaged(_with_mesh(rig, vertices, rig.mesh.faces, rows), added, "vertices")


def press_limb(rig: Rig, seed: int) -> Damaged:
    """Press a limb with some tenth of the vertices to half a cell of thickness."""
    assert rig.weights is not None
    follows = rig.weights @ rig.skeleton.subtree.T > 0.5
    joint = int(np.abs(follows.mean(axis=0) - 0.1).argmin())
    chosen = np.flatnonzero(follows[:, joint])
    lattice = Lattice.around(rig.mesh, 64)
    unit = lattice.to_unit(rig.mesh.vertices)
    axis = int(np.ptp(unit[chosen], axis=0).argmin())
    along = unit[chosen, axis]
    middle = np.round(along.mean() * 64) / 64  # between two planes of lattice points
    unit[chosen, axis] = middle + (along - along.mean()) / np.ptp(along) * 0.5 / 64
    return Damaged(_with_mesh(rig, lattice.to_file(unit), rig.mesh.faces), chosen, "vertices")


def flatten(rig: Rig, seed: int) -> Damaged:
    """Press the mesh flat along its shortest side."""
    axis = int(np.ptp(rig.mesh.bounds, axis=0).argmin())
    vertices = rig.mesh.vertices.copy()
    middle = rig.mesh.bounds.mean(axis=0)[axis]
    # A fiftieth of a cell, between two planes of the lattice: these lie evenly about the middle.
    thin = _size(rig) / 64 / 50
    vertices[:, axis] = middle + (vertices[:, axis] - middle) / np.ptp(vertices[:, axis]) * thin
    return Damaged(_with_mesh(rig, vertices, rig.mesh.faces), rig.mesh.used, "vertices")


def detached_part(rig: Rig, seed: int) -> Damaged:
    """Put a large sheet beside the body."""
    vertices, size = rig.mesh.vertices, _size(rig)
    u, v = np.meshgrid(np.linspace(0, 0.4, 9), np.linspace(0, 0.4, 9), indexing="ij")
    sheet = np.stack([u.ravel(), v.ravel(), 0 * u.ravel()], axis=1) * size
    sheet += rig.mesh.bounds[1] + 0.1 * size
    a = np.arange(81).reshape(9, 9)
    b, c, d, e = a[:-1, :-1].ravel(), a[1:, :-1].ravel(), a[1:, 1:].ravel(), a[:-1, 1:].ravel()
    added = np.concatenate([np.stack([b, c, d], 1), np.stack([b, d, e], 1)]) + len(vertices)
    rows = np.concatenate([np.arange(len(vertices)), np.zeros(81, int)])
    faces = np.concatenate([rig.mesh.faces, added])
    damaged = _with_mesh(rig, np.concatenate([vertices, sheet]), faces, rows)
    return Damaged(damaged, np.arange(len(vertices), len(vertices) + 81), "vertices")


def stuck_box(rig: Rig, seed: int) -> Damaged:
    """Stick small boxes half into the skin."""
    vertices, faces = rig.mesh.vertices, rig.mesh.faces
    box = trimesh.creation.box(extents=[0.02 * _size(rig)] * 3)
    points, corners = [vertices], [faces]
    count = len(vertices)
    for face in _middles(rig)[_around(_middles(rig), 6, seed)]:
        points.append(box.vertices + face)
        corners.append(box.faces + count)
        count += len(box.vertices)
    rows = np.concatenate([np.arange(len(vertices)), np.zeros(count - len(vertices), int)])
    damaged = _with_mesh(rig, np.concatenate(points), np.concatenate(corners), rows)
    return Damaged(damaged, np.arange(len(faces), len(damaged.mesh.faces)), "faces")


def joint_outside(rig: Rig, seed: int) -> Damaged:
    """Move a last joint out of the body."""
    joint = _leaf(rig)
    joints = rig.skeleton.joints.copy()
    away = joints[joint] - rig.mesh.bounds.mean(axis=0)
    joints[joint] += 0.6 * _size(rig) * away / max(np.linalg.norm(away), 1e-12)
    return Damaged(_with_joints(rig, joints), np.array([joint]), "joints")


def coincident_joints(rig: Rig, seed: int) -> Damaged:
    """Move a last joint to the place of another that is not its parent."""
    skeleton = rig.skeleton
    joint = _leaf(rig)
    others = skeleton.deform.copy()
    others[[joint, max(int(skeleton.parents[joint]), 0)]] = False
    others &= skeleton.parents != joint
    other = int(np.flatnonzero(others)[seed % others.sum()])
    joints = skeleton.joints.copy()
    joints[joint] = joints[other]
    return Damaged(_with_joints(rig, joints), np.array([joint, other]), "joints")


def joint_on_parent(rig: Rig, seed: int) -> Damaged:
    """Move a joint to where its parent is."""
    skeleton = rig.skeleton
    has_parent = skeleton.deform & (skeleton.parents >= 0)
    has_parent &= skeleton.deform[np.maximum(skeleton.parents, 0)]
    joint = int(np.flatnonzero(has_parent)[-1]) if has_parent.any() else 0
    joints = skeleton.joints.copy()
    joints[joint] = joints[skeleton.parents[joint]]
    return Damaged(_with_joints(rig, joints), np.array([joint]), "joints")


def flat_hierarchy(rig: Rig, seed: int) -> Damaged:
    """Make every joint a root."""
    count = len(rig.skeleton.joints)
    flat = _with_joints(rig, rig.skeleton.joints, np.full(count, -1))
    return Damaged(flat, np.arange(count), "joints")


def add_control(rig: Rig, seed: int) -> Damaged:
    """Add a joint that animators pull limbs by, on the floor beside the body."""
    skeleton, count = rig.skeleton, len(rig.skeleton.joints)
    place = rig.mesh.bounds[0] - 0.1 * _size(rig)
    with_control = Skeleton(
        np.concatenate([skeleton.joints, [place]]),
        np.append(skeleton.parents, -1),
        (*skeleton.names, "IK_Foot_Pole"),
        np.append(skeleton.deform, False),
    )
    plain = replace(rig, weights=None, allowed=None, weight_sums=None, source=None, clips=())
    more = replace(plain, skeleton=with_control)
    if rig.weights is not None:
        more = more.with_weights(np.column_stack([rig.weights, np.zeros(len(rig.weights))]))
    return Damaged(more, np.array([count]), "joints")


def unused_joint(rig: Rig, seed: int) -> Damaged:
    """Give all weight of an inner joint to its parent."""
    assert rig.weights is not None
    skeleton = rig.skeleton
    inner = [j for j in np.flatnonzero(skeleton.deform & (skeleton.parents >= 0))
             if len(skeleton.children[j]) and skeleton.deform[skeleton.parents[j]]]  # fmt: skip
    joint = int(inner[len(inner) // 2]) if inner else int(np.flatnonzero(skeleton.deform)[-1])
    weights = rig.weights.copy()
    weights[:, max(int(skeleton.parents[joint]), 0)] += weights[:, joint]
    weights[:, joint] = 0
    deform = skeleton.deform.copy()
    deform[joint] = False
    with_joint = Skeleton(skeleton.joints, skeleton.parents, skeleton.names, deform)
    damaged = replace(rig, skeleton=with_joint, source=None, clips=()).with_weights(weights)
    return Damaged(damaged, np.array([joint]), "joints")


def _patch(rig: Rig, seed: int, share: int = 20) -> NDArray[np.intp]:
    """Return vertices around one, with all that lie where these do."""
    used = rig.mesh.used
    chosen = used[_around(rig.mesh.vertices[used], max(len(used) // share, 6), seed)]
    place = rig.mesh.welded.index
    return np.intersect1d(np.flatnonzero(np.isin(place, place[chosen])), used)


def leak_weights(rig: Rig, seed: int) -> Damaged:
    """Give a patch of skin some weight of the joint that is farthest away from it."""
    assert rig.weights is not None
    joints = np.flatnonzero(rig.skeleton.deform)
    leaf = rig.skeleton.joints[_leaf(rig)]
    used = rig.mesh.used
    near = used[np.argsort(np.linalg.norm(rig.mesh.vertices[used] - leaf, axis=1))]
    chosen = np.sort(near[: max(len(used) // 30, 6)])
    away = np.linalg.norm(rig.skeleton.joints[joints] - leaf, axis=1)
    inside = cKDTree(rig.mesh.vertices[used]).query(rig.skeleton.joints[joints])[0]
    far = joints[np.where(inside < 0.15 * _size(rig), away, -1).argmax()]
    weights = rig.weights.copy()
    weights[chosen] *= 0.6
    weights[chosen, far] += 0.4
    return Damaged(replace(rig, source=None).with_weights(weights), chosen, "vertices")


def _reread(rig: Rig, folder: Path, change: Callable[[dict[str, NDArray]], None]) -> Rig:
    """Return the rig after its file's arrays were changed."""
    path = folder / "damaged.npz"
    cutcell.save(path, replace(rig, source=None))
    with np.load(path) as archive:
        arrays = dict(archive)
    change(arrays)
    np.savez(path, **arrays)  # type: ignore[arg-type]
    return cutcell.load(path)


def nan_weights(rig: Rig, seed: int, folder: Path) -> Damaged:
    """Write weights that are no numbers."""
    chosen = _patch(rig, seed)

    def change(arrays: dict[str, NDArray]) -> None:
        where = np.isin(arrays["skinning_weights_row"], chosen)
        arrays["skinning_weights_value"][where] = np.nan

    return Damaged(_reread(rig, folder, change), chosen, "vertices")


def unnormalised_weights(rig: Rig, seed: int, folder: Path) -> Damaged:
    """Write weights that sum to three quarters."""
    chosen = _patch(rig, seed)

    def change(arrays: dict[str, NDArray]) -> None:
        where = np.isin(arrays["skinning_weights_row"], chosen)
        arrays["skinning_weights_value"][where] *= 0.75

    return Damaged(_reread(rig, folder, change), chosen, "vertices")


def no_weights(rig: Rig, seed: int) -> Damaged:
    """Take all weight from a patch of skin."""
    assert rig.weights is not None
    chosen = _patch(rig, seed)
    weights = rig.weights.copy()
    weights[chosen] = 0
    return Damaged(replace(rig, source=None).with_weights(weights), chosen, "vertices")


def many_influences(rig: Rig, seed: int) -> Damaged:
    """Give a patch of the skin to six joints."""
    assert rig.weights is not None
    chosen = _patch(rig, seed)
    joints = np.flatnonzero(rig.skeleton.deform)
    middle = rig.mesh.vertices[chosen].mean(axis=0)
    near = joints[np.argsort(np.linalg.norm(rig.skeleton.joints[joints] - middle, axis=1))[:6]]
    weights = rig.weights.copy()
    weights[chosen] = 0
    weights[np.ix_(chosen, near)] = 1 / len(near)
    return Damaged(replace(rig, source=None).with_weights(weights), chosen, "vertices")


def tear_seams(rig: Rig, seed: int) -> Damaged:
    """Give the corners of adjacent faces to different joints."""
    split = split_seams(rig, seed).rig
    assert split.weights is not None
    chosen = _patch(split, seed, share=8)
    chosen = chosen[chosen % 2 == 0]
    joints = np.flatnonzero(rig.skeleton.deform)
    weights = split.weights.copy()
    weights[chosen] *= 0.8
    weights[chosen, joints[0]] += 0.2
    staying = np.abs(weights[chosen] - split.weights[chosen]).sum(axis=1) > 0.05
    return Damaged(split.with_weights(weights), chosen[staying], "vertices")


DAMAGES: dict[str, tuple[str, Callable[..., Damaged]]] = {
    "a patch of faces turned": ("inverted-faces", flip_patch),
    "every third face turned": ("inverted-faces", flip_some),
    "all faces turned": ("inverted-faces", flip_whole),
    "faces deleted": ("holes", delete_faces),
    "a hole torn": ("rims", tear_hole),
    "faces doubled": ("duplicate-faces", duplicate_faces),
    "faces without area": ("degenerate-faces", degenerate_faces),
    "fins on edges": ("non-manifold-edges", add_fins),
    "corners split": ("unwelded-vertices", split_seams),
    "a crack opened": ("cracks", open_crack),
    "a vertex astray": ("stray-vertices", stray_vertex),
    "vertices added": ("unused-vertices", add_vertices),
    "a limb pressed flat": ("thin-parts", press_limb),
    "pressed flat": ("no-interior", flatten),
    "a sheet beside it": ("unreachable-vertices", detached_part),
    "boxes stuck into it": ("self-intersections", stuck_box),
    "a joint outside": ("joints-outside", joint_outside),
    "joints in one place": ("coincident-joints", coincident_joints),
    "a joint on its parent": ("zero-length-bones", joint_on_parent),
    "no hierarchy": ("flat-hierarchy", flat_hierarchy),
    "a control added": ("control-joints", add_control),
    "a joint without weight": ("unused-joints", unused_joint),
    "weight leaked": ("leaked-weights", leak_weights),
    "weights no numbers": ("invalid-weights", nan_weights),
    "weights of 3/4": ("unnormalised-weights", unnormalised_weights),
    "skin without weight": ("unweighted-vertices", no_weights),
    "six influences": ("many-influences", many_influences),
    "seams that tear": ("torn-seams", tear_seams),
}
"""Name of each damage, code of the finding that must report it, and function that makes it."""
READING = (nan_weights, unnormalised_weights)
"""Damages of files: they take a folder to write one to."""
