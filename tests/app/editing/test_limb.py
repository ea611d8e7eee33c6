"""The centre of a limb's cross-section."""

import numpy as np
import pytest
import trimesh
from scipy.spatial.transform import Rotation

from cutcell import Rig, Skeleton, TriangleMesh
from cutcell_app.editing.compute.limb import DIRECTIONS, cross_section_centre


@pytest.mark.parametrize("sections", [4, 12, 32, DIRECTIONS])
def test_a_direction_through_an_edge_meets_the_skin(sections):
    """The edges of a tube lie in the directions that are looked in, up to rounding."""
    tube = trimesh.creation.cylinder(0.5, 4.0, sections=sections)
    joints = np.array([[0, 0, -1.5], [0, 0, 0.3], [0, 0, 1.5]])
    for seed in range(30):
        turn = Rotation.random(rng=seed).as_matrix()
        # The directions begin across the bone and one of the axes: turn the edges to them.
        out = turn[:, 2]
        side = np.cross(out, np.eye(3)[np.abs(out).argmin()])
        side /= np.linalg.norm(side)
        turn = np.stack([side, np.cross(out, side), out], axis=1)
        rig = Rig(
            TriangleMesh(tube.vertices @ turn.T, tube.faces),
            Skeleton(joints @ turn.T, [-1, 0, 1]),
        )
        centre = cross_section_centre(rig, 1)
        np.testing.assert_allclose(centre, rig.skeleton.joints[1], atol=1e-9)
