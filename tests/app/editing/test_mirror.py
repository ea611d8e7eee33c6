"""Mirrored joints: partners where the mesh has none."""

import numpy as np
import pytest

import cutcell
from cutcell import Rig, Skeleton, TriangleMesh
from cutcell.errors import SkeletonError
from cutcell_app.editing.compute.mirror import joint_mirror
from tests.meshes import box


def test_the_joints_of_a_character_with_a_parting_in_its_hair_are_mirrored(demo_paths):
    rig = cutcell.load(demo_paths[0].with_name("biped.glb"))
    mirror = joint_mirror(rig)
    names = np.array(rig.skeleton.names)
    other = [name.translate(str.maketrans("LR", "RL")) for name in names]
    assert mirror.axis == 0
    assert names[mirror.joint].tolist() == other
    half = rig.skeleton.joints.copy()
    half[:, 0] = np.abs(half[:, 0]) + np.linspace(0, 0.4, len(half))
    with pytest.raises(SkeletonError, match="is not mirrored across x, y or z"):
        joint_mirror(rig.with_joints(half))


def test_without_joints_there_is_no_partner():
    rig = Rig(TriangleMesh(*box()), Skeleton(np.empty((0, 3)), []))
    with pytest.raises(SkeletonError, match="has no joints"):
        joint_mirror(rig)
