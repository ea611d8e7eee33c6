"""Distances by several measures: in a straight bar all are known, and paths are as long as told."""

import numpy as np
import pytest
from scipy.sparse import coo_array
from scipy.sparse.csgraph import dijkstra

import cutcell
from cutcell.errors import ParameterError
from cutcell_lab.baselines.body import Body
from cutcell_lab.baselines.measured_distance import MEASURES, measure_distance
from cutcell_lab.baselines.volumes.voxel_binding import voxel_distances
from cutcell_lab.baselines.volumes.voxels import voxelize
from tests.bars import bar, fork

METHOD = cutcell.PAPER.with_options(resolution=24)


def measured(rig, measure, joint=0):
    return measure_distance(rig, cutcell.bind(rig, method=METHOD).distances, joint, measure, METHOD)


@pytest.mark.parametrize("measure", MEASURES)
def test_a_path_is_as_long_as_the_distance_and_ends_at_the_bone(measure):
    rig = bar(20)
    result = measured(rig, measure)
    bone = rig.skeleton.joints[:2]
    for vertex in (0, 100, len(rig.mesh.vertices) - 1):
        path = result.path_from(vertex)
        np.testing.assert_allclose(path[0], rig.mesh.vertices[vertex], atol=1e-9)
        away = np.linalg.norm(path[-1] - np.clip(path[-1], bone[0], bone[1]))
        length = np.linalg.norm(np.diff(path, axis=0), axis=1).sum()
        # Voxels that hold the bone are at distance 0; others add the way to it, or walk it.
        off = 0 if measure == "voxel" else away
        assert length + off == pytest.approx(result.vertices[vertex], rel=0.03, abs=1e-6)
        assert away < 0.11


def test_measures_are_ordered_as_their_paths_may_go():
    rig = fork()
    by = {measure: measured(rig, measure, joint=2).vertices for measure in MEASURES}
    slack = 1e-9
    for measure in MEASURES:
        assert (by["straight"] <= by[measure] + 2 / METHOD.resolution).all()
    assert (by["any"] <= by["26"] + slack).all()
    assert (by["26"] <= by["6"] + slack).all()
    other = rig.mesh.vertices[:, 0] > 0.9
    other &= rig.mesh.vertices[:, 1] > 0.15  # the tip of the other prong
    assert by["straight"][other].max() < 0.2
    assert by["any"][other].min() > 0.4
    assert by["voxel"][other].max() < 0.5 * by["any"][other].min()  # over the narrow gap


def test_in_the_graph_and_in_voxels_it_is_what_binding_measures():
    rig = fork()
    distances = cutcell.bind(rig, method=METHOD).distances
    for connectivity in (6, 26, "any"):
        method = METHOD.with_options(connectivity=connectivity)
        wanted = cutcell.bind(rig, method=method).distances.joint[2]
        result = measure_distance(rig, distances, 2, str(connectivity), METHOD)
        np.testing.assert_allclose(result.vertices, wanted, rtol=1e-6)
    body = Body.of(rig, resolution=24)
    wanted = body.joint_minimum(voxel_distances(body))[2][body.index]
    np.testing.assert_allclose(measured(rig, "voxel", 2).vertices, wanted, atol=1e-9)


def test_over_the_surface_equals_dijkstra_from_each_source():
    rig = bar(8)
    result = measured(rig, "surface")
    vertices, faces = rig.mesh.vertices, rig.mesh.faces
    a, b = np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]]).T
    length = np.linalg.norm(vertices[a] - vertices[b], axis=1)
    pairs = {tuple(sorted(pair)): x for *pair, x in zip(a, b, length, strict=True)}
    ends = np.array(list(pairs))
    matrix = coo_array((list(pairs.values()), ends.T), shape=(len(vertices),) * 2).tocsr()
    every = dijkstra(matrix, directed=False)
    for vertex in range(0, len(vertices), 7):
        path = result.path_from(vertex)
        source = np.flatnonzero((np.abs(vertices - path[-1]) < 1e-9).all(axis=1))[0]
        along = np.linalg.norm(np.diff(path, axis=0), axis=1).sum()
        assert along == pytest.approx(every[vertex, source], abs=1e-9)


def test_the_seen_sides_of_voxels_close_around_them():
    rig = bar(8)
    result = measured(rig, "voxel")
    a, b, c, d = result.sides.transpose(1, 0, 2)
    volume = sum(
        np.einsum("ij,ij->i", p, np.cross(q, r)).sum() for p, q, r in ((a, b, c), (a, c, d))
    )
    body = Body.of(rig, resolution=24)

    solid = int(voxelize(body).solid.sum())
    assert volume / 6 == pytest.approx(solid * (body.lattice.size / 24) ** 3)
    # In the straight bar distances grow along it, and corners at one place have one value.
    corners, at = np.unique(result.sides.reshape(-1, 3).round(9), axis=0, return_inverse=True)
    least, most = np.full(len(corners), np.inf), np.zeros(len(corners))
    np.minimum.at(least, at, result.side_distance.ravel())
    np.maximum.at(most, at, result.side_distance.ravel())
    np.testing.assert_array_equal(least, most)
    beyond = corners[:, 0] > 0.6
    assert np.corrcoef(corners[beyond, 0], most[beyond])[0, 1] > 0.98


def test_what_no_path_reaches_has_none():
    near, far = bar(6), bar(6)
    above = far.mesh.vertices + np.array([0, 3, 0])
    vertices = np.concatenate([near.mesh.vertices, above])
    faces = np.concatenate([near.mesh.faces, far.mesh.faces + len(near.mesh.vertices)])
    rig = cutcell.Rig(cutcell.TriangleMesh(vertices, faces), near.skeleton)
    for measure in MEASURES:
        result = measured(rig, measure)
        is_reached = np.isfinite(result.vertices[-1])
        assert is_reached == (measure == "straight")
        assert (len(result.path_from(len(vertices) - 1)) > 0) == is_reached


def test_what_is_wrong_is_said():
    rig = fork()
    distances = cutcell.bind(rig, method=METHOD).distances
    with pytest.raises(ParameterError, match="measure must be"):
        measure_distance(rig, distances, 0, "thought", METHOD)
    with pytest.raises(ParameterError, match="may not carry weight"):
        measure_distance(rig, distances, 1, "any", METHOD)
