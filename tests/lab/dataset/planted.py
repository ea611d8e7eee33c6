"""A character, and the same again as people make it differ, to be found by an audit."""

from dataclasses import replace

import numpy as np

import cutcell
from cutcell.rig import Rig, Skeleton, TriangleMesh
from cutcell_assets.generate import generate


def planted() -> dict[str, Rig]:
    """Return a beast, and the same as people make it differ."""
    rig = generate("beast", 4, detail=32, clean=True)
    mesh, skeleton = rig.mesh, rig.skeleton
    order = np.random.default_rng(0).permutation(len(mesh.vertices))
    inverse = np.argsort(order)
    finer = generate("beast", 4, detail=44, clean=True)
    mirror = np.array([-1.0, 1, 1])
    turns = np.tile(np.eye(3), (len(skeleton.joints), 1, 1))
    for joint in range(1, len(turns)):
        turns[joint] = cutcell.pose.axis_rotation("xyz"[joint % 3], 35.0 * (-1) ** joint)
    moved = cutcell.forward_kinematics(skeleton, turns)
    posed = cutcell.linear_blend_skinning(mesh.vertices, rig.weights, moved)
    there = np.einsum("jab,jb->ja", moved[:, :3, :3], skeleton.joints) + moved[:, :3, 3]
    centre = mesh.vertices[np.argmax(mesh.vertices[:, 1])]
    cape = centre + np.array([[0, 0, -0.15], [0, 0, 0.15], [0, 0.2, 0.15], [0, 0.2, -0.15]])
    sides = np.array([[0, 1, 2], [0, 2, 3]]) + len(mesh.vertices)
    dressed = TriangleMesh(
        np.concatenate([mesh.vertices, cape]), np.concatenate([mesh.faces, sides])
    )
    return {
        "original": rig,
        "order": Rig(TriangleMesh(mesh.vertices[order], inverse[mesh.faces]), skeleton),
        "units": Rig(
            TriangleMesh(mesh.vertices * 100 + 7, mesh.faces),
            replace(skeleton, joints=skeleton.joints * 100 + 7),
        ),
        "remeshed": finer,
        "mirrored": Rig(
            TriangleMesh(mesh.vertices * mirror, mesh.faces[:, ::-1]),
            replace(skeleton, joints=skeleton.joints * mirror),
        ),
        "clothes": Rig(dressed, skeleton),
        "pose": Rig(TriangleMesh(posed, mesh.faces), Skeleton(there, skeleton.parents)),
        "other": generate("beast", 5, detail=32, clean=True),
    }
