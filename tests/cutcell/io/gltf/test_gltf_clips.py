"""Clips move the mesh as glTF's own rules would, written out one vertex at a time."""

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.spatial.transform import Rotation, Slerp

import cutcell
from cutcell.io.gltf.nodes import compose, decompose
from tests.cutcell.io.gltf.gltf_builder import COLUMN, JOINTS, REST, SHARES, column, moved

REST_POSE = {"translation": [0, 0, 0], "rotation": [0, 0, 0, 1], "scale": [1, 1, 1]}


def quaternions(*degrees, axis="z"):
    return Rotation.from_euler(axis, np.reshape(degrees, (-1, 1)), degrees=True).as_quat()


def animate(builder, *channels, name="wave"):
    """Add an animation; a channel is (node, path, keys, values, interpolation)."""
    animation = {"name": name, "channels": [], "samplers": []}
    for node, path, keys, values, how in channels:
        sampler = {"input": builder.accessor(np.array(keys, float), min=[keys[0]], max=[keys[-1]])}
        sampler |= {"output": builder.accessor(np.array(values)), "interpolation": how}
        animation["samplers"].append(sampler)
        target = {"node": node, "path": path}
        animation["channels"].append({"sampler": len(animation["samplers"]) - 1, "target": target})
    builder.add("animations", animation)


def value_at(keys, values, how, path, t):
    """Sample one channel at one time, after the glTF specification."""
    values = np.asarray(values, float)
    width = 4 if path == "rotation" else 3
    if how == "CUBICSPLINE":
        values = values.reshape(len(keys), 3, width)
    t = min(max(t, keys[0]), keys[-1])
    k = max(i for i in range(len(keys)) if keys[i] <= t + 1e-12)
    if k == len(keys) - 1:
        return values[k][1] if how == "CUBICSPLINE" else values[k]
    span = keys[k + 1] - keys[k]
    u = (t - keys[k]) / span
    if how == "STEP":
        return values[k]
    if how == "CUBICSPLINE":
        p0, m0, p1, m1 = values[k][1], values[k][2], values[k + 1][1], values[k + 1][0]
        return (
            (2 * u**3 - 3 * u**2 + 1) * p0
            + span * (u**3 - 2 * u**2 + u) * m0
            + (-2 * u**3 + 3 * u**2) * p1
            + span * (u**3 - u**2) * m1
        )
    if path == "rotation":
        return Slerp([0, 1], Rotation.from_quat(values[k : k + 2]))(u).as_quat()
    return values[k] * (1 - u) + values[k + 1] * u


def scene_vertices(builder, channels, t, inverse, joints=(0, 1)):
    """Skin the column at one time, in the scene: loops, and scipy's rotations."""
    local, parent = [], {}
    for i, node in enumerate(builder.json["nodes"]):
        pose = {k: node.get(k, v) for k, v in REST_POSE.items()}
        for target, path, keys, values, how in channels:
            if target == i:
                pose[path] = value_at(keys, values, how, path, t)
        matrix = np.eye(4)
        matrix[:3, :3] = Rotation.from_quat(pose["rotation"]).as_matrix() * pose["scale"]
        matrix[:3, 3] = pose["translation"]
        local.append(matrix)
        parent |= {c: i for c in node.get("children", [])}

    def world(i):
        return world(parent[i]) @ local[i] if i in parent else local[i]

    out = []
    for vertex, names, shares in zip(COLUMN, JOINTS, SHARES, strict=True):
        point = np.zeros(4)
        for k in range(4):
            matrix = world(joints[names[k]]) @ inverse[names[k]]
            point += shares[k] * matrix @ [*vertex, 1]
        out.append(point[:3])
    return np.array(out)


def played(rig, frame_transforms):
    """Blend with the file's weights and go from the rig's space to the scene."""
    posed = cutcell.linear_blend_skinning(rig.mesh.vertices, rig.weights, frame_transforms)
    return posed @ rig.world[:3, :3].T + rig.world[:3, 3]


TURNS = quaternions(0, 100, -60, 170)
LINEAR = [(1, "rotation", [0, 0.4, 0.9, 1.5], TURNS, "LINEAR")]
FLIPPED = [(1, "rotation", [0, 0.4, 0.9, 1.5], TURNS * [[1], [-1], [1], [-1]], "LINEAR")]
STEP = [(0, "translation", [0, 0.5, 1.0], [[0, 0, 0], [1, 2, 3], [0, 1, 0]], "STEP")]
SPLINE_KEYS = np.random.default_rng(3).normal(size=(3, 3, 3))
SPLINE = [(1, "scale", [0, 0.7, 1.0], SPLINE_KEYS.reshape(9, 3), "CUBICSPLINE")]
SPUN_KEYS = np.random.default_rng(4).normal(size=(3, 3, 4)) * [[[0.3], [1], [0.3]]]
SPUN = [(1, "rotation", [0, 0.7, 1.0], SPUN_KEYS.reshape(9, 4), "CUBICSPLINE")]
ABOVE = [(3, "rotation", [0, 1], quaternions(0, 90, axis="y"), "LINEAR"), *LINEAR]
LATE = [(1, "rotation", [0.5, 1], quaternions(30, 60), "LINEAR")]
BOTH_PARTS = [*STEP, *LINEAR, (1, "scale", [0, 1], [[1, 1, 1], [2, 1, 0.5]], "LINEAR")]


@pytest.mark.parametrize("channels", [LINEAR, FLIPPED, STEP, SPLINE, SPUN, ABOVE, LATE, BOTH_PARTS])
def test_clips_do_what_gltf_says(loaded, channels):
    builder = column()
    # Above the joints: another node, which stretches and may itself be animated.
    builder.json["scenes"][0]["nodes"] = [3, 2]
    above = {"scale": [2, 1, 1], "translation": [0, 0, 4], "children": [0]}
    builder.add("nodes", above)
    animate(builder, *channels)
    rig = loaded(builder)
    (clip,) = rig.clips
    inverse = [moved(*-p) for p in REST]
    assert clip.name == "wave"
    assert clip.times[0] == 0
    assert clip.duration == pytest.approx(max(c[2][-1] for c in channels))
    assert np.diff(clip.times).min() >= 1 / 30 - 1e-9
    for t, transforms in zip(clip.times, clip.transforms, strict=True):
        expected = scene_vertices(builder, channels, t, inverse)
        assert_allclose(played(rig, transforms), expected, atol=2e-5)


def test_a_clip_of_one_frame(loaded):
    builder = column()
    animate(builder, (1, "rotation", [0], quaternions(45), "LINEAR"))
    (clip,) = loaded(builder).clips
    assert clip.duration == 0
    assert clip.transforms.shape == (1, 2, 4, 4)


def test_a_long_clip_is_sampled_more_coarsely(loaded):
    builder = column()
    animate(builder, (1, "rotation", [0, 36000], quaternions(0, 45), "LINEAR"))
    (clip,) = loaded(builder).clips
    assert clip.duration == 36000
    assert len(clip.times) == 3601


def test_animations_that_move_no_joint_are_no_clips(loaded):
    builder = column()
    animate(builder, (2, "translation", [0, 1], np.zeros((2, 3)), "LINEAR"))
    builder.json["animations"].append({"channels": [], "samplers": []})
    assert loaded(builder).clips == ()


def test_morph_targets_are_passed_over(loaded):
    builder = column()
    animate(builder, *LINEAR)
    animation = builder.json["animations"][0]
    animation["channels"].append({"sampler": 0, "target": {"node": 2, "path": "weights"}})
    assert len(loaded(builder).clips) == 1


def test_a_joint_given_as_a_matrix_can_be_animated(loaded):
    builder = column()
    node = builder.json["nodes"][1]
    del node["translation"]
    matrix = compose(np.array([0, 1.0, 0]), quaternions(30)[0], np.array([1, 2.0, -3]))
    node["matrix"] = matrix.T.ravel().tolist()
    animate(builder, (1, "translation", [0, 1], [[0, 1, 0], [5, 1, 0]], "LINEAR"))
    (clip,) = loaded(builder).clips
    at_rest = moved(*REST[0]) @ matrix @ moved(*-REST[1])
    assert_allclose(clip.transforms[0, 1], at_rest, atol=1e-6)
    assert_allclose(
        clip.transforms[-1, 1] - clip.transforms[0, 1], moved(5, 0, 0) - np.eye(4), atol=1e-6
    )


def test_matrices_are_composed_again_from_their_parts():
    rng = np.random.default_rng(0)
    parts = rng.normal(size=(50, 3)), rng.normal(size=(50, 4)), rng.normal(size=(50, 3))
    matrices = compose(*parts)
    assert_allclose(compose(*decompose(matrices)), matrices, atol=1e-12)


def test_real_clips_start_near_the_mesh(rigs):
    """Every clip of every character keeps it roughly its size."""
    for path in rigs:
        rig = cutcell.load(path)
        size = np.linalg.norm(np.ptp(rig.mesh.vertices, axis=0))
        for clip in rig.clips:
            frame = clip.transforms[len(clip.times) // 2]
            posed = cutcell.linear_blend_skinning(rig.mesh.vertices, rig.weights, frame)
            assert 0.3 < np.linalg.norm(np.ptp(posed, axis=0)) / size < 3, (path.name, clip.name)
