"""Distances equal slow Dijkstra's, begin at the right nodes, and fall back with a reason."""

import numpy as np
import pytest
from scipy.sparse import csr_array
from scipy.sparse.csgraph import dijkstra
from scipy.spatial.distance import cdist

import cutcell
from cutcell import (
    Cancelled,
    ParameterError,
    Skeleton,
    SkeletonError,
    TriangleMesh,
    WeightsError,
    bone_segments,
)
from cutcell.bones.bones import MAX_SAMPLED_LENGTH
from cutcell.geodesics import FALLBACK_REASONS, bone_samples
from cutcell.geodesics.fallback import NOT_ALLOWED, REACHED, UNREACHED, UNUSED
from cutcell.geometry.segments import distance_to_segment
from tests import meshes, naive
from tests.bars import bar
from tests.paper import bone_distances, build_graph

ARM = Skeleton(
    [[0.5, 0.5, 0.3], [0.5, 0.5, 0.5], [0.5, 0.52, 0.7]], [-1, 0, 1], ["root", "elbow", "hand"]
)


def with_second_part(vertices, faces):
    """Put a small box beside a mesh that touches nothing."""
    extra, extra_faces = meshes.box(1.2, 1.3)
    return (
        np.concatenate([vertices, extra]),
        np.concatenate([faces, extra_faces + len(vertices)]),
    )


@pytest.mark.parametrize("leaf", ["point", "extend", "fit"])
@pytest.mark.parametrize("deform", [[True, True, False], [False, True, True]])
def test_a_far_joint_that_does_not_deform_has_few_samples(leaf, deform):
    rig = bar(joints=3)
    graph = cutcell.build_graph(rig.mesh, 16)
    results = []
    for far in (50, 25_000, 1e12):
        joints = rig.skeleton.joints.copy()
        joints[deform.index(False), 1] += far
        skeleton = Skeleton(joints, [-1, 0, 1], deform=deform)
        distances = cutcell.bone_distances(graph, skeleton, leaf=leaf)
        counts = np.bincount(bone_samples(graph, distances.bones)[1])
        assert counts.max() <= MAX_SAMPLED_LENGTH * 16 + 1
        results.append(distances.joint)
    np.testing.assert_allclose(results[1], results[0], atol=0.05)
    np.testing.assert_allclose(results[2], results[1], atol=0.05)


def test_a_skeleton_in_other_units_is_refused():
    rig = bar()
    graph = cutcell.build_graph(rig.mesh, 16)
    skeleton = Skeleton(100 * rig.skeleton.joints, rig.skeleton.parents)
    with pytest.raises(SkeletonError, match="are skeleton and mesh in the same units"):
        cutcell.bone_distances(graph, skeleton)


@pytest.mark.parametrize("connectivity", [6, 26])
@pytest.mark.parametrize("leaf", ["point", "extend"])
@pytest.mark.parametrize("name", meshes.ALL)
def test_distances_equal_the_slow_ones(name, leaf, connectivity):
    graph = build_graph(TriangleMesh(*meshes.ALL[name]()), 10, connectivity=connectivity)
    distances = bone_distances(graph, ARM, leaf=leaf)
    for b in range(len(distances.bones.joint)):
        mine = distances.sources.bone == b
        sources = dict(
            zip(distances.sources.node[mine], distances.sources.distance[mine], strict=True)
        )
        slow = naive.shortest_paths(len(graph.nodes), graph.edges, graph.lengths, sources)
        reached = distances.fallback == REACHED
        np.testing.assert_allclose(
            distances.joint[b, reached], slow[graph.vertex_node][reached], rtol=1e-12
        )
        if np.isfinite(slow).all():
            joint = distances.bones.joint[b]
            field = distances.field(joint)
            assert (field <= slow + 1e-12).all()


def test_distances_equal_scipy_on_a_large_graph():
    graph = build_graph(TriangleMesh(*meshes.ball(3)), 24, connectivity=26)
    distances = bone_distances(graph, ARM)
    count = len(graph.nodes)
    for b in range(2):
        mine = distances.sources.bone == b
        # One node more, from which every source is as far as its bone.
        matrix = graph.csr().tocoo()
        row = np.concatenate([matrix.row, np.full(mine.sum(), count)])
        col = np.concatenate([matrix.col, distances.sources.node[mine]])
        data = np.concatenate([matrix.data, distances.sources.distance[mine]])
        linked = csr_array((data, (row, col)), shape=(count + 1, count + 1))
        expected = dijkstra(linked, indices=count)[graph.vertex_node]
        np.testing.assert_allclose(distances.joint[b], expected, rtol=1e-12)


def test_sources_are_the_nearest_nodes():
    graph = build_graph(TriangleMesh(*meshes.torus()), 12)
    skeleton = Skeleton([[0.5, 0.83, 0.5], [0.83, 0.5, 0.51]], [-1, 0])
    distances = bone_distances(graph, skeleton, samples=7)
    bones = distances.bones
    for b in range(len(bones.joint)):
        points = bones.start[b] + np.linspace(0, 1, 7)[:, None] * (bones.end[b] - bones.start[b])
        apart = cdist(points, graph.nodes)
        nearest = set(np.nonzero(apart <= apart.min(axis=1, keepdims=True) * (1 + 1e-9))[1])
        mine = distances.sources.bone == b
        assert set(distances.sources.node[mine]) == nearest
        straight = distance_to_segment(
            graph.nodes[distances.sources.node[mine]], bones.start[b], bones.end[b]
        )
        np.testing.assert_allclose(distances.sources.distance[mine], straight)


def test_a_joint_is_as_near_as_its_nearest_bone():
    fork = Skeleton([[0.5, 0.5, 0.5], [0.6, 0.5, 0.7], [0.4, 0.5, 0.7]], [-1, 0, 0])
    graph = build_graph(TriangleMesh(*meshes.ball()), 12, connectivity="any")
    distances = bone_distances(graph, fork)
    assert distances.bones.joint.tolist() == [0, 0, 1, 2]
    bones = distances.bones
    unit = graph.nodes[graph.vertex_node]
    straight = distance_to_segment(unit[:, None], bones.start[:2], bones.end[:2]).min(axis=1)
    np.testing.assert_allclose(distances.joint[0], straight)
    np.testing.assert_array_equal(distances.field(1)[graph.vertex_node], distances.joint[1])
    np.testing.assert_array_equal(distances.least, distances.joint.min(axis=0))
    np.testing.assert_array_equal(distances.nearest_joint, distances.joint.argmin(axis=0))
    for one in ((slice(None), 3), (1, slice(None)), ([0, 1], [5, 7])):
        np.testing.assert_array_equal(distances.at(*one), distances.joint[one])


def test_joints_without_weight_have_no_bone():
    skeleton = Skeleton(ARM.joints, ARM.parents, ARM.names, [True, False, True])
    graph = build_graph(TriangleMesh(*meshes.ball()), 8)
    distances = bone_distances(graph, skeleton)
    assert np.isinf(distances.joint[1]).all()
    with pytest.raises(ParameterError, match="joint 1 has no bone"):
        distances.field(1)


def test_bones_run_to_the_children_and_leaves_may_be_extended():
    points = bone_segments(ARM, "point")
    np.testing.assert_allclose(points.end[:2], ARM.joints[1:])
    np.testing.assert_allclose(points.end[2], points.start[2])
    extended = bone_segments(ARM, "extend")
    np.testing.assert_allclose(extended.end[2], [0.5, 0.53, 0.8])
    lone = bone_segments(Skeleton([[0, 0, 0]], [-1]), "extend")
    np.testing.assert_array_equal(lone.start, lone.end)
    with pytest.raises(ParameterError, match="leaf must be one of 'point', 'extend'"):
        bone_segments(ARM, "guess")


def test_parts_that_no_path_reaches_follow_three_bones():
    vertices, faces = with_second_part(*meshes.ball())
    graph = build_graph(TriangleMesh(vertices, faces), 16)
    chain = Skeleton([[0.5, 0.5, 0.1 * k] for k in range(2, 8)], range(-1, 5))
    distances = bone_distances(graph, chain)
    lost = np.arange(len(vertices)) >= len(vertices) - 8
    np.testing.assert_array_equal(distances.fallback == UNREACHED, lost)
    assert (np.isfinite(distances.joint[:, lost]).sum(axis=0) == 3).all()
    unit = graph.lattice.to_unit(vertices[-1])
    straight = distance_to_segment(unit, distances.bones.start, distances.bones.end)
    np.testing.assert_allclose(np.sort(distances.joint[:, -1])[:3], np.sort(straight)[:3])
    assert "no path" in FALLBACK_REASONS[UNREACHED]


def test_unused_vertices_fall_back_and_never_become_sources():
    vertices, faces = meshes.ball()
    vertices = np.concatenate([vertices, [[0.5, 0.5, 0.3]]])  # right on the root
    graph = build_graph(TriangleMesh(vertices, faces), 4)
    distances = bone_distances(graph, ARM)
    assert distances.fallback[-1] == UNUSED
    assert graph.vertex_node[-1] not in distances.sources.node
    assert np.isfinite(distances.joint[:, -1]).all()


def test_a_vertex_follows_only_joints_its_file_can_store():
    vertices, faces = meshes.ball()
    graph = build_graph(TriangleMesh(vertices, faces), 8)
    allowed = np.ones((len(vertices), 3), bool)
    allowed[5, [0, 2]] = False
    distances = bone_distances(graph, ARM, allowed=allowed)
    assert np.isfinite(distances.joint[:, 5]).tolist() == [False, True, False]

    vertices, faces = with_second_part(vertices, faces)
    graph = build_graph(TriangleMesh(vertices, faces), 8)
    allowed = np.ones((len(vertices), 3), bool)
    allowed[-1] = [False, False, True]
    distances = bone_distances(graph, ARM, allowed=allowed)
    assert np.isfinite(distances.joint[:, -1]).tolist() == [False, False, True]


def test_a_vertex_whose_joints_cannot_reach_it_falls_back_among_them():
    ball, faces = meshes.ball()
    vertices, faces = with_second_part(ball, faces)
    skeleton = Skeleton([[0.5, 0.5, 0.5], [1.25, 1.25, 1.25]], [-1, -1])
    graph = build_graph(TriangleMesh(vertices, faces), 32)
    allowed = np.ones((len(vertices), 2), bool)
    allowed[-1] = [True, False]
    distances = bone_distances(graph, skeleton, allowed=allowed)
    assert distances.fallback[-1] == NOT_ALLOWED
    assert np.isfinite(distances.joint[:, -1]).tolist() == [True, False]


def test_allowed_is_checked():
    graph = build_graph(TriangleMesh(*meshes.ball()), 4)
    with pytest.raises(WeightsError, match="allowed has the shape"):
        bone_distances(graph, ARM, allowed=np.ones((2, 3), bool))
    nothing = np.zeros((len(graph.vertex_node), 3), bool)
    with pytest.raises(WeightsError, match="vertex 0 may follow no joint"):
        bone_distances(graph, ARM, allowed=nothing)


@pytest.mark.parametrize(("name", "value"), [("samples", 0), ("nearest", 0), ("samples", 2.5)])
def test_parameters_are_checked(name, value):
    graph = build_graph(TriangleMesh(*meshes.ball()), 4)
    with pytest.raises(ParameterError, match=f"{name} must be a whole number"):
        bone_distances(graph, ARM, **{name: value})


def test_progress_and_cancel():
    graph = build_graph(TriangleMesh(*meshes.ball()), 4)
    seen = []
    bone_distances(graph, ARM, progress=lambda s, f: seen.append((s, f)))
    assert {s for s, _ in seen} == {"distances"}
    assert seen[-1][1] == 1.0

    def cancel(stage, fraction):
        raise Cancelled

    with pytest.raises(Cancelled):
        bone_distances(graph, ARM, progress=cancel)
