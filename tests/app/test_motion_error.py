"""The error of a motion equals that of moving the mesh, frame by frame."""

import numpy as np
import pytest

from cutcell.pose import linear_blend_skinning, swing
from cutcell_app.features.pose.errors import motion_error
from cutcell_viewers.skin import Gap
from tests.lab.metrics.test_metrics import chain, random_weights


def test_the_error_of_a_motion_is_that_of_its_frames():
    rig = chain()
    clip = swing(rig.skeleton, 1, "z", 40, fps=5)
    computed, reference = random_weights(rig, 1), random_weights(rig, 2)
    points = rig.mesh.vertices
    lengths = []
    for pose in clip.transforms:
        one, other = (
            linear_blend_skinning(points, weights, pose) for weights in (computed, reference)
        )
        lengths.append(np.linalg.norm(one - other, axis=1))
    rms, greatest, most = motion_error(clip, Gap(points, computed, reference))
    assert rms == pytest.approx(np.sqrt(np.square(lengths).mean()), rel=1e-4)
    assert greatest == pytest.approx(np.max(lengths), rel=1e-4)
    assert rms < most <= greatest
    assert motion_error(clip, Gap(points, computed, computed)) == (0, 0, 0)
