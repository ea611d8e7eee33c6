"""A rig from anywhere becomes a GLB that other programs open."""

from dataclasses import replace

import numpy as np
import pygltflib
import pytest
from numpy.testing import assert_allclose, assert_array_equal

import cutcell
from cutcell.io.materials.surfaces import vertex_normals
from cutcell.pose import swing
from tests.cutcell.io.gltf.gltf_builder import COLUMN, FACES, REST, SHARES
from tests.gltf_validator.validator import errors, reports


def small_rig(**fields):
    skeleton = cutcell.Skeleton(REST, [-1, 0], ("root", "tip"))
    return cutcell.Rig(cutcell.TriangleMesh(COLUMN, FACES), skeleton, SHARES[:, :2], **fields)


def check_valid(path):
    (report,) = reports(path)
    assert report["issues"]["numErrors"] == 0, report["issues"]["messages"]
    assert report["issues"]["numWarnings"] == 0, report["issues"]["messages"]
    assert errors(report) == {}


def test_mesh_skeleton_and_weights_come_back(tmp_path):
    world = np.array([[0, 0, 2, 1], [2, 0, 0, 0], [0, 2, 0, 0], [0, 0, 0, 1.0]])
    sword = cutcell.Attachment("sword", cutcell.TriangleMesh(COLUMN + 1, FACES), 1)
    rig = small_rig(world=world, attachments=(sword,), name="pillar")
    cutcell.save(tmp_path / "new.glb", rig)
    check_valid(tmp_path / "new.glb")
    again = cutcell.load(tmp_path / "new.glb")
    assert_array_equal(again.mesh.vertices, rig.mesh.vertices)
    assert_array_equal(again.mesh.faces, rig.mesh.faces)
    assert_allclose(again.weights, rig.weights, atol=1e-7)
    assert_allclose(again.skeleton.joints, rig.skeleton.joints)
    assert_array_equal(again.skeleton.parents, rig.skeleton.parents)
    assert again.skeleton.names == rig.skeleton.names
    assert_allclose(again.world, world, atol=1e-12)
    assert again.attachments[0].joint == 1
    assert_allclose(again.attachments[0].mesh.vertices, COLUMN + 1, atol=1e-6)


def test_clips_come_back(tmp_path):
    rig = small_rig()
    turn = swing(rig.skeleton, 0, "z", 170, seconds=1)
    stretch = turn.transforms.copy()
    stretch[:, 1, :3, :3] *= 2
    clips = (turn, cutcell.Clip("stretch", turn.times, stretch))
    cutcell.save(tmp_path / "new.glb", replace(rig, clips=clips))
    check_valid(tmp_path / "new.glb")
    again = cutcell.load(tmp_path / "new.glb").clips
    assert [c.name for c in again] == ["swing root", "stretch"]
    for before, after in zip(clips, again, strict=True):
        assert_allclose(after.times, before.times, atol=1e-6)
        assert_allclose(after.transforms, before.transforms, atol=1e-5)


def test_many_joints_roots_and_influences(tmp_path):
    rng = np.random.default_rng(0)
    joints = rng.random((300, 3))
    weights = rng.random((12, 300)) * (rng.random((12, 300)) < 0.05)
    weights /= weights.sum(axis=1, keepdims=True)
    parents = np.maximum(np.arange(300) - 3, -1)
    skeleton = cutcell.Skeleton(joints, parents)
    rig = cutcell.Rig(cutcell.TriangleMesh(COLUMN, FACES), skeleton, weights)
    cutcell.save(tmp_path / "new.glb", rig)
    check_valid(tmp_path / "new.glb")
    again = cutcell.load(tmp_path / "new.glb")
    assert_allclose(again.weights, weights, atol=1e-7)
    assert_array_equal(again.skeleton.parents, parents)
    assert_allclose(again.skeleton.joints, joints, atol=1e-7)


def test_vertices_without_a_face_have_a_normal_too():
    mesh = cutcell.TriangleMesh(np.concatenate([COLUMN, [[5, 5, 5]]]), FACES)
    assert_allclose(np.linalg.norm(vertex_normals(mesh.vertices, mesh.faces), axis=1), 1, atol=1e-6)


def test_normals_point_out_and_do_not_see_seams():
    mesh = cutcell.TriangleMesh(COLUMN[FACES].reshape(-1, 3), np.arange(FACES.size).reshape(-1, 3))
    normals = vertex_normals(mesh.vertices, mesh.faces)
    outward = mesh.vertices - [0.5, 1, 0.5]
    assert ((normals * outward).sum(axis=1) > 0).all()
    _, same = np.unique(mesh.vertices, axis=0, return_inverse=True)
    for k in range(same.max() + 1):
        assert np.ptp(normals[same.reshape(-1) == k], axis=0).max() == 0


def test_another_library_reads_it(tmp_path):
    cutcell.save(tmp_path / "new.glb", small_rig())
    gltf = pygltflib.GLTF2.load_binary(str(tmp_path / "new.glb"))
    assert [gltf.nodes[j].name for j in gltf.skins[0].joints] == ["root", "tip"]
    assert gltf.materials[0].pbrMetallicRoughness.metallicFactor == 0


def test_without_weights_there_is_nothing_to_save(tmp_path):
    with pytest.raises(cutcell.WeightsError, match=r"new\.glb: the rig has no weights"):
        cutcell.save(tmp_path / "new.glb", small_rig().with_weights(None))


def test_text_with_its_buffer_beside_it(tmp_path):
    (tmp_path / "new.bin").write_text("of something else")
    files = tmp_path / "new-2.bin", tmp_path / "new.gltf"
    for _ in range(2):  # its own buffer is replaced
        assert cutcell.save(tmp_path / "new.gltf", small_rig()) == files
    check_valid(tmp_path / "new.gltf")
    again = cutcell.load(tmp_path / "new.gltf")
    assert_array_equal(again.mesh.vertices, small_rig().mesh.vertices)
    assert_allclose(again.weights, small_rig().weights, atol=1e-7)
    assert (tmp_path / "new.bin").read_text() == "of something else"


def test_real_characters_can_be_made_anew(tmp_path, rigs):
    for path in rigs[1:5]:
        rig = cutcell.load(path)
        cutcell.save(tmp_path / path.name, replace(rig, source=None))
        assert errors(reports(tmp_path / path.name)[0]) == {}
        again = cutcell.load(tmp_path / path.name)
        assert_allclose(again.weights, rig.weights, atol=1e-6)
        for before, after in zip(rig.clips, again.clips, strict=True):
            assert_allclose(after.transforms, before.transforms, atol=1e-4)


def turned_rig(mirrored):
    """Return the column with turned joints, the second one mirrored if wanted, and a clip."""
    rng = np.random.default_rng(3)
    axes = np.linalg.qr(rng.normal(size=(2, 3, 3)))[0]
    axes *= np.linalg.det(axes)[:, None, None]
    if mirrored:
        axes[1, :, 0] *= -1
    skeleton = cutcell.Skeleton(REST, [-1, 0], ("root", "tip"), orientations=axes)
    sword = cutcell.Attachment("sword", cutcell.TriangleMesh(COLUMN + 1, FACES), 1)
    clip = swing(skeleton, 0, "z", 50, seconds=0.5)
    rig = small_rig()
    return cutcell.Rig(rig.mesh, skeleton, rig.weights, (clip,), (sword,))


@pytest.mark.parametrize("mirrored", [False, True])
def test_how_joints_are_turned_at_rest_comes_back(tmp_path, mirrored):
    rig = turned_rig(mirrored)
    cutcell.save(tmp_path / "new.glb", rig)
    check_valid(tmp_path / "new.glb")
    again = cutcell.load(tmp_path / "new.glb")
    assert_allclose(again.skeleton.orientations, rig.skeleton.orientations, atol=1e-6)
    assert_allclose(again.skeleton.joints, rig.skeleton.joints, atol=1e-6)
    assert_allclose(again.world, np.eye(4), atol=1e-6)
    assert_allclose(again.clips[0].transforms, rig.clips[0].transforms, atol=1e-5)
    assert_allclose(again.attachments[0].mesh.vertices, COLUMN + 1, atol=1e-6)
