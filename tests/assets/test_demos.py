"""Every demo character is what its title says, and looks as it should when it moves."""

import json
import struct
import subprocess
import sys
from itertools import pairwise

import numpy as np
import pygltflib
import pytest
import trimesh
from scipy import sparse
from scipy.sparse.csgraph import connected_components
from scipy.spatial import cKDTree

from cutcell_assets import DEMOS, demo_path
from tests.gltf_validator.validator import errors, reports

from .conftest import load

IDS = [demo.id for demo in DEMOS]


def gap(a, b):
    """Return the least distance between two sets of vertices."""
    return cKDTree(a).query(b)[0].min()


def test_khronos_validator_finds_no_error():
    for id, report in zip(IDS, reports(*map(demo_path, IDS)), strict=True):
        assert not errors(report), id
        assert report["issues"]["numWarnings"] == 0, id


def read(document, accessor):
    """Return a VEC3 accessor's numbers."""
    accessor = document.accessors[accessor]
    view = document.bufferViews[accessor.bufferView]
    data = document.binary_blob()[view.byteOffset : view.byteOffset + view.byteLength]
    return np.frombuffer(data, np.float32).reshape(-1, 3)


def height(demo):
    return np.ptp(demo.vertices[:, 1])


def test_the_walker_comes_first():
    assert IDS[0] == "biped"
    assert len(set(IDS)) == len(IDS)


def test_an_unknown_demo_names_the_known_ones():
    with pytest.raises(KeyError, match=r"'bipedal'.*biped, rabbit"):
        demo_path("bipedal")


def test_naming_the_demos_loads_no_heavy_library():
    code = (
        "import sys, assets; print([m for m in ('numpy', 'scipy', 'skimage') if m in sys.modules])"
    )
    out = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert out.stdout.strip() == "[]"


def test_all_files_together_are_small():
    sizes = [demo_path(id).stat().st_size for id in IDS]
    assert max(sizes) < 1.5e6
    assert sum(sizes) < 6e6


@pytest.mark.parametrize("id", IDS)
def test_files_hold_what_a_rig_needs(id):
    data = demo_path(id).read_bytes()
    length = struct.unpack_from("<I", data, 12)[0]
    document = json.loads(data[20 : 20 + length])
    assert [len(document[k]) for k in ("skins", "animations", "meshes")] == [1, 1, 1]
    assert len(document["materials"]) >= 2
    for primitive in document["meshes"][0]["primitives"]:
        assert {"POSITION", "JOINTS_0", "WEIGHTS_0"} <= set(primitive["attributes"])
        assert ("NORMAL" in primitive["attributes"]) != (id == "biped_soup")


@pytest.mark.parametrize("id", IDS)
def test_characters_stand_on_the_ground(id):
    demo = load(id)
    low, high = demo.rig.mesh.bounds
    assert abs(low[1]) < 0.03
    assert 0.9 < high[1] - low[1] < 1.8
    assert abs(low[0] + high[0]) < 0.1  # in the middle


@pytest.mark.parametrize("id", IDS)
def test_weights_are_sound(id):
    rig = load(id).rig
    np.testing.assert_allclose(rig.weights.sum(axis=1), 1, atol=1e-6)
    assert rig.weights.min() >= 0
    assert (rig.weights > 0).sum(axis=1).max() <= 4


@pytest.mark.parametrize("id", IDS)
def test_clips_loop_and_start_near_the_rest_pose(id):
    rig = load(id).rig
    (clip,) = rig.clips
    assert 0.5 < clip.duration <= 4
    np.testing.assert_allclose(clip.transforms[0], clip.transforms[-1], atol=1e-4)
    assert np.ptp(clip.transforms, axis=0).max() > 0.1


@pytest.mark.parametrize("id", IDS)
def test_motion_stretches_no_edge_far(id):
    # Skin shared by limbs that only lie near each other would be torn out of shape.
    demo = load(id)
    (clip,) = demo.rig.clips
    edges = np.unique(np.sort(demo.faces[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2), axis=1), axis=0)
    rest = np.linalg.norm(np.subtract(*demo.vertices[edges].transpose(1, 0, 2)), axis=1)
    points = np.column_stack([demo.vertices, np.ones(len(demo.vertices))])
    for transforms in clip.transforms[::5]:
        matrices = np.tensordot(demo.weights, transforms, 1)
        posed = np.einsum("nab,nb->na", matrices, points)[:, :3]
        span = np.linalg.norm(np.subtract(*posed[edges].transpose(1, 0, 2)), axis=1)
        assert np.quantile(span / rest, 0.999) < 2.5
        assert (span - rest).max() < 0.05  # metres


def test_closed_characters_are_one_closed_ball(closed):
    mesh = trimesh.Trimesh(closed.vertices, closed.faces, process=False)
    assert mesh.is_watertight
    assert mesh.is_winding_consistent
    assert mesh.volume > 0.01
    assert mesh.body_count == 1
    assert mesh.euler_number == 2
    assert 7000 < len(closed.vertices) < 16000


def test_triangles_are_well_shaped(closed):
    mesh = trimesh.Trimesh(closed.vertices, closed.faces, process=False)
    smallest = np.degrees(mesh.face_angles.min(axis=1))
    assert smallest.min() > 0.5
    assert (smallest < 15).mean() < 0.003
    assert np.median(smallest) > 45


@pytest.mark.parametrize("id", ["biped", "rabbit", "octopus", "robot"])
def test_normals_point_out_of_the_triangles(id):
    document = pygltflib.GLTF2().load(demo_path(id))
    faces = load(id).rig.mesh.faces
    corners = load(id).rig.mesh.vertices[faces]
    outward = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    outward /= np.linalg.norm(outward, axis=1, keepdims=True)
    normals = np.concatenate(
        [read(document, p.attributes.NORMAL) for p in document.meshes[0].primitives]
    )
    np.testing.assert_allclose(np.linalg.norm(normals, axis=1), 1, atol=1e-5)
    agree = (normals[faces].mean(axis=1) * outward).sum(axis=1)
    assert (agree > 0.5).mean() > 0.995


def test_each_joint_holds_one_piece_of_the_skin(closed):
    # The back must not follow the ears that lie on it, nor a finger its neighbour.
    start = closed.faces[:, [0, 1, 2]].ravel()
    end = closed.faces[:, [1, 2, 0]].ravel()
    for name, weight in zip(closed.rig.skeleton.names, closed.weights.T, strict=True):
        held = weight > 0
        inside = held[start] & held[end]
        links = sparse.coo_array(
            (np.ones(inside.sum()), (start[inside], end[inside])), shape=(len(held),) * 2
        )
        pieces = np.bincount(connected_components(links, directed=False)[1][held])
        assert held.sum() > 10, name
        assert pieces.max() > 0.9 * held.sum(), name


def test_the_walker_has_five_fingers_a_hand():
    names = load("biped").rig.skeleton.names
    for side in "LR":
        for finger in ("thumb", "index", "middle", "ring", "pinky"):
            assert {f"{finger}{k}.{side}" for k in (1, 2, 3)} <= set(names)
    assert len(names) == 52


@pytest.mark.parametrize("side", ["L", "R"])
def test_the_walkers_hands_hang_close_to_its_hips(side):
    demo = load("biped")
    hand = ("forearm", "hand", "index", "middle", "ring", "pinky", "thumb")
    mine = demo.owner
    arm = demo.vertices[[n.startswith(hand) and n.endswith(side) for n in mine]]
    body = demo.vertices[np.isin(mine, ["hips", "spine1", "thigh.L", "thigh.R"])]
    assert 0.015 < gap(arm, body) / height(demo) < 0.025


@pytest.mark.parametrize("side", ["L", "R"])
def test_the_walkers_fingers_are_apart(side):
    demo = load("biped")
    fingers = ("thumb", "index", "middle", "ring", "pinky")
    for a, b in pairwise(fingers):
        ends = [demo.held_by(*(f"{f}{k}.{side}" for k in (2, 3))) for f in (a, b)]
        assert gap(*ends) > 0.005


def test_the_rabbits_ears_lie_on_its_back_without_touching_it():
    demo = load("rabbit")
    trunk = demo.held_by("hips", "spine", "chest", "neck")
    for side in "LR":
        ear = demo.held_by(*(f"ear{k}.{side}" for k in (2, 3, 4)))
        air = cKDTree(trunk).query(ear)[0]
        assert 0.01 < air.min() < 0.03
        assert np.median(air) < 0.07
    ears = [demo.held_by(*(f"ear{k}.{s}" for k in (2, 3, 4))) for s in "LR"]
    assert gap(*ears) > 0.02


def test_the_octopus_has_eight_separate_arms():
    demo = load("octopus")
    arms = [demo.held_by(*(f"arm{a}{k}" for k in range(2, 7))) for a in "ABCDEFGH"]
    for k, arm in enumerate(arms):
        assert len(arm) > 100
        assert gap(arm, arms[k - 1]) > 0.02


def test_the_robots_plates_are_closed_rigid_and_apart():
    demo = load("robot")
    mesh = trimesh.Trimesh(demo.vertices, demo.faces, process=False)
    plates = mesh.split(only_watertight=False)
    assert len(plates) > 60
    assert all(plate.is_watertight and plate.volume > 0 for plate in plates)
    assert set(np.unique(demo.weights)) == {0.0, 1.0}


def test_the_robots_ring_touches_nothing():
    demo = load("robot")
    mesh = trimesh.Trimesh(demo.vertices, demo.faces, process=False)
    plates = mesh.split(only_watertight=False)
    ring = max(plates, key=lambda plate: np.ptp(plate.vertices[:, 0]))
    assert ring.euler_number == 0
    rest = np.concatenate([plate.vertices for plate in plates if plate is not ring])
    assert gap(ring.vertices, rest) > 0.03
