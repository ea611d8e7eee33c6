"""Errors over clips equal those of moving the mesh, frame by frame."""

from dataclasses import replace

import numpy as np
import pytest

from cutcell.pose import linear_blend_skinning, swing
from cutcell_lab.metrics import clip_error, clips
from tests.lab.metrics.test_metrics import chain, random_weights


def test_clips_are_compared_frame_by_frame(monkeypatch):
    still = chain()
    motion = swing(still.skeleton, 1, "z", 40), swing(still.skeleton, 2, "x", 10)
    rig = replace(still, clips=motion)
    computed, reference = random_weights(rig, 1), random_weights(rig, 2)
    clip = rig.clips[0]
    scale = 100 / np.ptp(rig.mesh.vertices, axis=0).max()
    moved = [
        [
            linear_blend_skinning(rig.mesh.vertices, weights, pose)
            for weights in (computed, reference)
        ]
        for pose in clip.transforms
    ]
    slow = [scale**2 * np.sum((one - other) ** 2, axis=1) for one, other in moved]
    monkeypatch.setattr(clips, "FRAMES", 1000)
    errors = clip_error(rig, computed, reference)
    assert [error.name for error in errors] == ["swing arm", "swing hand"]
    assert errors[0].frames == len(clip.times)
    assert errors[0].mean == pytest.approx(np.mean(slow))
    assert errors[0].largest == pytest.approx(np.max(slow, axis=0).mean())
    monkeypatch.setattr(clips, "FRAMES", 5)
    assert clip_error(rig, computed, reference)[0].frames == 5
    assert clip_error(still, computed, reference) == ()
