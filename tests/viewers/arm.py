"""A small character for tests of scenes and page: a beam with three joints in a row."""

import numpy as np
import trimesh

from cutcell.pose import rotate_joint
from cutcell.rig import Attachment, Clip, Rig, Skeleton, TriangleMesh

# The beam's space has z up, the scene y.
WORLD = np.array([[1.0, 0, 0, 0], [0, 0, 1, 0], [0, -1, 0, 0], [0, 0, 0, 1]])


def arm_rig() -> Rig:
    beam = trimesh.creation.box(extents=(3.0, 0.6, 0.6)).subdivide_to_size(0.3)
    mesh = TriangleMesh(beam.vertices, beam.faces)
    skeleton = Skeleton(
        [[-1.4, 0, 0], [0.0, 0, 0], [1.0, 0, 0]], [-1, 0, 1], ("shoulder", "elbow", "wrist")
    )
    weights = np.eye(3)[np.digitize(mesh.vertices[:, 0], [0.0, 1.0])]
    bent = rotate_joint(skeleton, 1, "z", 60)
    clip = Clip("wave", np.array([0.0, 1.0]), np.stack([np.tile(np.eye(4), (3, 1, 1)), bent]))
    sword = trimesh.creation.box(extents=(0.1, 0.1, 1.0))
    hung = Attachment("sword", TriangleMesh(sword.vertices + np.array([1.4, 0, 0]), sword.faces), 2)
    return Rig(mesh, skeleton, weights, (clip,), (hung,), name="arm.glb", world=WORLD)


def bare_arm() -> Rig:
    return Rig(arm_rig().mesh, Skeleton([], []), name="statue", warnings=("it has no skin",))
