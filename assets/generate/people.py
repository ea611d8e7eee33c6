"""People from the package anny: MakeHuman's bodies with hand-made weights."""

from __future__ import annotations

import sys
from contextlib import redirect_stdout
from functools import cache
from typing import Any

import numpy as np

from cutcell.rig import Rig, Skeleton, TriangleMesh

POSED = ("upperarm", "lowerarm", "upperleg", "lowerleg", "spine", "neck")
"""Beginnings of the names of the bones that are turned."""
DEGREES = 12.0
"""Standard deviation of their turns."""
UPRIGHT = np.array([[1.0, 0.0, 0.0], [0.0, 0.0, -1.0], [0.0, 1.0, 0.0]])
"""Rows x, y, z where z is up, times this, are rows where y is."""


def person(random: np.random.Generator) -> Rig:
    """Return a person of drawn age, build and pose; y is up, as in all that is generated."""
    # anny's kernels are compiled by warp, which prints what it does where our results belong.
    with redirect_stdout(sys.stderr):
        return _person(random)


def _person(random: np.random.Generator) -> Rig:
    import torch

    model = _model()
    pose = np.tile(np.eye(4), (model.bone_count, 1, 1))
    for bone, name in enumerate(model.bone_labels):
        if name.startswith(POSED):
            pose[bone, :3, :3] = _turn(np.radians(random.normal(0, DEGREES, 3)))
    build = {name: float(random.uniform(0.1, 0.9)) for name in model.phenotype_labels}
    with torch.no_grad():
        made = model(pose_parameters=torch.from_numpy(pose)[None].float(), phenotype_kwargs=build)
    vertices = made["vertices"][0].double().numpy() @ UPRIGHT
    joints = made["bone_poses"][0, :, :3, 3].double().numpy() @ UPRIGHT
    faces = np.asarray(model.faces)
    if faces.shape[1] == 4:
        faces = np.concatenate([faces[:, [0, 1, 2]], faces[:, [0, 2, 3]]])
    bones = np.asarray(model.vertex_bone_indices)
    values = np.asarray(model.vertex_bone_weights, np.float64)
    weights = np.zeros((len(vertices), model.bone_count))
    np.add.at(weights, (np.arange(len(vertices))[:, None], bones), values)
    skeleton = Skeleton(joints, np.asarray(model.bone_parents), tuple(model.bone_labels))
    return Rig(
        TriangleMesh(vertices, faces), skeleton, weights / weights.sum(axis=1, keepdims=True)
    )


@cache
def _model() -> Any:
    import anny
    import torch

    return anny.Anny().to(dtype=torch.float32)


def _turn(angles: np.ndarray) -> np.ndarray:
    """Return the rotation about an axis by its length, shape (3, 3) (Rodrigues)."""
    angle = max(float(np.linalg.norm(angles)), 1e-12)
    x, y, z = angles / angle
    across = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return np.eye(3) + np.sin(angle) * across + (1 - np.cos(angle)) * across @ across
