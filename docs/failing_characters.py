"""Characters on which weights fail, made from the demos and from a generated figure."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import trimesh
from numpy.typing import NDArray

import cutcell
from cutcell import Rig, Skeleton, TriangleMesh
from cutcell.pose import linear_blend_skinning, rotate_joint
from cutcell_assets import demo_path
from cutcell_assets.generate import generate
from cutcell_assets.generate.shapes import Limbs, melted

FIGURE = ("body", 5)
"""Kind and number of the generated character that most failures begin with."""
DETAIL = 72


def demo(id: str) -> Callable[[], Rig]:
    return lambda: cutcell.load(demo_path(id))


def _figure() -> Rig:
    kind, number = FIGURE
    return generate(kind, number, detail=DETAIL, clean=True)  # type: ignore[arg-type]


def _with_mesh(
    rig: Rig, vertices: NDArray, faces: NDArray, skeleton: Skeleton | None = None
) -> Rig:
    return Rig(TriangleMesh(vertices, faces), skeleton or rig.skeleton, name=rig.name)


def _below(rig: Rig, bone: str, least: float = 0.5) -> NDArray[np.bool_]:
    """Return the vertices that follow a bone or those below it."""
    joint = rig.skeleton.names.index(bone)
    return np.asarray(rig.weights @ rig.skeleton.subtree[joint] > least)


def ring() -> Rig:
    """Put a ring around the left forearm, a little apart from it."""
    rig = _figure()
    joints, names = rig.skeleton.joints, rig.skeleton.names
    elbow, wrist = (joints[names.index(f"left_arm_{k}")] for k in (2, 3))
    along = (wrist - elbow) / np.linalg.norm(wrist - elbow)
    vertices, middle = rig.mesh.vertices, (elbow + wrist) / 2
    near = np.abs((vertices - middle) @ along) < 0.02
    near &= _below(rig, "left_arm_1")
    off = vertices[near] - middle
    off -= np.outer(off @ along, along)
    ring = trimesh.creation.torus(np.linalg.norm(off, axis=1).max() + 0.035, 0.018)
    turn = trimesh.geometry.align_vectors([0, 0, 1], along)[:3, :3]
    added = ring.vertices @ turn.T + middle + off.mean(axis=0)
    faces = np.concatenate([rig.mesh.faces, ring.faces + len(vertices)])
    return _with_mesh(rig, np.concatenate([vertices, added]), faces)


def flipped_patch() -> Rig:
    """Turn the faces of the belly inside out."""
    rig = _figure()
    faces, middles = rig.mesh.faces, rig.mesh.vertices[rig.mesh.faces].mean(axis=1)
    spine = rig.skeleton.joints[rig.skeleton.names.index("spine")]
    patch = (np.linalg.norm(middles - spine, axis=1) < 0.3) & (middles[:, 2] > spine[2])
    return _with_mesh(rig, rig.mesh.vertices, np.where(patch[:, None], faces[:, ::-1], faces))


def bottle() -> Rig:
    """Make a hollow tube with a thin wall, whose bones are in the cavity."""

    def tube(wide: float, ends: tuple[float, float]) -> Rig:
        limbs = Limbs()
        heights = np.linspace(*ends, 6)
        limbs.chain("spine", -1, np.stack([0 * heights, heights, 0 * heights], 1), [wide] * 6)
        return melted(limbs, 60, 0.01)

    outer, inner = tube(0.16, (0.2, 1.2)), tube(0.152, (0.2, 1.2))
    count = len(outer.mesh.vertices)
    vertices = np.concatenate([outer.mesh.vertices, inner.mesh.vertices])
    faces = np.concatenate([outer.mesh.faces, inner.mesh.faces[:, ::-1] + count])
    return replace(_with_mesh(outer, vertices, faces), name="bottle")


def crossing() -> Rig:
    """Lower the left arm until the hand is inside the thigh."""
    rig = _figure()
    arm = rig.skeleton.names.index("left_arm_1")
    matrices = rotate_joint(rig.skeleton, arm, "z", -108)
    vertices = linear_blend_skinning(rig.mesh.vertices, rig.weights, matrices)
    joints = np.einsum("jab,jb->ja", matrices[:, :3, :3], rig.skeleton.joints)
    skeleton = Skeleton(joints + matrices[:, :3, 3], rig.skeleton.parents, rig.skeleton.names)
    return _with_mesh(rig, vertices, rig.mesh.faces, skeleton)


def torn() -> Rig:
    """Remove the faces of the back, so that the body is open like a shell."""
    rig = _figure()
    middles = rig.mesh.vertices[rig.mesh.faces].mean(axis=1)
    spine = rig.skeleton.joints[rig.skeleton.names.index("spine")]
    lost = (np.linalg.norm(middles - spine, axis=1) < 0.22) & (middles[:, 2] < spine[2])
    used, faces = np.unique(rig.mesh.faces[~lost], return_inverse=True)
    return _with_mesh(rig, rig.mesh.vertices[used], faces.reshape(-1, 3))


def far_part() -> Rig:
    """Add a button of another scene, five sizes of the body away."""
    rig = _figure()
    ball = trimesh.creation.icosphere(1, 0.03)
    vertices = np.concatenate([rig.mesh.vertices, ball.vertices + np.array([5.0, 0, 0])])
    faces = np.concatenate([rig.mesh.faces, ball.faces + len(rig.mesh.vertices)])
    return _with_mesh(rig, vertices, faces)


def fingers() -> Rig:
    """Make a palm with two fingers, and bend their tips until two thousandths are between them."""
    limbs = Limbs()
    palm = limbs.add("palm", -1, [-0.3, 0, 0], [0.3, 0, 0], 0.12, 0.12)
    for side, name in ((-1, "right"), (1, "left")):
        x = side * np.array([0.3, 0.3, 0.25, 0.12])
        points = np.stack([x, [0.0, 0.4, 0.8, 1.1], 0 * x], 1)
        limbs.chain(name, palm, points, [0.1, 0.09, 0.08, 0.07])
    rig = melted(limbs, DETAIL, 0.005)
    vertices = rig.mesh.vertices.copy()
    tips = vertices[:, 1] > 0.6
    gap = np.abs(vertices[tips, 0]).min()
    bent = np.clip((vertices[tips, 1] - 0.6) / 0.4, 0, 1) * (gap - 0.001)
    vertices[tips, 0] -= np.sign(vertices[tips, 0]) * bent
    return replace(_with_mesh(rig, vertices, rig.mesh.faces), name="two fingers")


def bone_outside() -> Rig:
    """Move the left elbow in front of the body."""
    rig = _figure()
    joints = rig.skeleton.joints.copy()
    joints[rig.skeleton.names.index("left_arm_2")] += [0, 0, 0.45]
    skeleton = Skeleton(joints, rig.skeleton.parents, rig.skeleton.names)
    return _with_mesh(rig, rig.mesh.vertices, rig.mesh.faces, skeleton)


def other_units() -> Rig:
    """Give the skeleton 2.54 times the size of the mesh, as inches beside centimetres."""
    rig = _figure()
    joints = rig.skeleton.joints
    skeleton = Skeleton(2.54 * joints, rig.skeleton.parents, rig.skeleton.names)
    return _with_mesh(rig, rig.mesh.vertices, rig.mesh.faces, skeleton)
