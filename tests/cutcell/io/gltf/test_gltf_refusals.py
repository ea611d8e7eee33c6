"""What cannot be saved is refused, and leaves the files as they were."""

import os
from dataclasses import replace

import numpy as np
import pytest

import cutcell
from tests.cutcell.io.gltf.gltf_builder import column, two_skins


def test_a_failure_leaves_the_old_file(tmp_path, monkeypatch):
    path = column().save(tmp_path / "rig.glb")
    content = path.read_bytes()
    rig = cutcell.load(path)

    def full(*_):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(os, "replace", full)
    with pytest.raises(cutcell.FileError, match=r"rig\.glb: cannot be written \(No space left"):
        cutcell.save(path, rig)
    assert path.read_bytes() == content
    assert os.listdir(tmp_path) == ["rig.glb"]


def test_weight_that_the_skin_cannot_hold_is_refused(tmp_path):
    rig = cutcell.load(two_skins([3, 0, -2]).save(tmp_path / "in.glb"))
    weights = np.full(rig.weights.shape, 1 / 3)
    with pytest.raises(
        cutcell.WeightsError,
        match=r'out\.glb: mesh "column", primitive 0: vertex 0 has weight on the joint "extra"',
    ):
        cutcell.save(tmp_path / "out.glb", rig.with_weights(weights))
    assert not (tmp_path / "out.glb").exists()


def test_a_rig_that_is_no_longer_its_documents_is_refused(tmp_path):
    rig = cutcell.load(column().save(tmp_path / "in.glb"))
    short = cutcell.TriangleMesh(rig.mesh.vertices[:4], [[0, 1, 2]])
    with pytest.raises(
        cutcell.MeshError, match=r"out\.glb: the rig has 4 vertices, its document 12"
    ):
        cutcell.save(tmp_path / "out.glb", replace(rig, mesh=short, weights=rig.weights[:4]))
    other = cutcell.Skeleton(rig.skeleton.joints, rig.skeleton.parents, ("a", "b"))
    with pytest.raises(cutcell.SkeletonError, match="no longer those of its document"):
        cutcell.save(tmp_path / "out.glb", replace(rig, skeleton=other))
    with pytest.raises(cutcell.WeightsError, match="no weights to save; bind it first"):
        cutcell.save(tmp_path / "out.glb", rig.with_weights(None))
