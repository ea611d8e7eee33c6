"""Any-angle distances are the geodesic ones: in the open, around corners, beside walls."""

import itertools

import numpy as np
import pytest
import trimesh

from cutcell import ParameterError, Skeleton, TriangleMesh, load
from cutcell.animation.any_angle.contraction import _sorted_by_place, contract
from cutcell.animation.any_angle.theta_star import SPAN, any_angle_paths, least_distances
from cutcell.animation.any_angle.wavefront import partition_sources
from cutcell.bones.nearest import NodeGrid
from cutcell.geodesics.solver import find_sources
from cutcell.geometry.segments import distance_to_segment
from cutcell.rig.rows import to_dense
from cutcell_assets import demo_path
from tests import meshes
from tests.bars import fork
from tests.paper import bone_distances, build_graph


def l_bar():
    """Extrude an L, its reflex corner at (1/4, 1/4), and split its triangles up."""
    outline = [[0, 0], [1, 0], [1, 0.25], [0.25, 0.25], [0.25, 1], [0, 1]]
    bottom = [[0, 1, 2], [0, 2, 3], [0, 3, 4], [0, 4, 5]]
    vertices = [[x, y, z] for z in (0, 0.25) for x, y in outline]
    faces = [[a, c, b] for a, b, c in bottom] + [[a + 6, b + 6, c + 6] for a, b, c in bottom]
    for i in range(6):
        j = (i + 1) % 6
        faces += [[i, j, j + 6], [i, j + 6, i + 6]]
    mesh = trimesh.Trimesh(vertices, faces, process=False)
    for _ in range(4):
        mesh = mesh.subdivide()
    return np.array(mesh.vertices), np.array(mesh.faces, np.int32)


def along_the_l(points, start):
    """Measure geodesics in the L-bar: straight, or bent at the reflex edge, unrolled flat."""
    corner = np.array([0.25, 0.25])
    a, b = start[:2] - corner, points[:, :2] - corner
    # The start lies in the lower arm; the corner hides what lies beyond the line through it.
    hidden = (b[:, 1] > 0) & (a[0] * b[:, 1] - a[1] * b[:, 0] > 0)
    bent = np.linalg.norm(a) + np.linalg.norm(b, axis=1)
    straight = np.linalg.norm(a - b, axis=1)
    return np.hypot(np.where(hidden, bent, straight), points[:, 2] - start[2])


def distances_from(vertices, faces, start, end, resolution, connectivity="any"):
    graph = build_graph(TriangleMesh(vertices, faces), resolution, connectivity=connectivity)
    skeleton = Skeleton([start, end], [-1, 0], deform=[True, False])
    return bone_distances(graph, skeleton).joint[0] * graph.lattice.size


def test_what_sees_a_bone_has_its_straight_distance():
    vertices, faces = meshes.ball(4)
    start, end = np.array([0.4, 0.45, 0.3]), np.array([0.6, 0.5, 0.65])
    result = distances_from(vertices, faces, start, end, 32)
    np.testing.assert_allclose(result, distance_to_segment(vertices, start, end), rtol=1e-9)


def test_errors_around_a_corner_shrink_with_the_lattice():
    vertices, faces = l_bar()
    start = np.array([0.9, 0.1, 0.12])
    truth = along_the_l(vertices, start)
    errors = []
    for resolution in (16, 32, 64):
        result = distances_from(vertices, faces, start, start, resolution)
        far = truth > 2 / resolution
        errors.append(np.abs(result[far] / truth[far] - 1).mean())
    assert errors[0] > errors[1] > errors[2]
    assert errors[2] < 0.01
    six = distances_from(vertices, faces, start, start, 64, connectivity=6)
    assert np.abs(six[far] / truth[far] - 1).mean() > 0.2


@pytest.mark.parametrize("name", meshes.ALL)
def test_between_straight_and_along_the_edges(name):
    vertices, faces = meshes.ALL[name]()
    start, end = np.array([0.5, 0.5, 0.35]), np.array([0.55, 0.5, 0.6])
    edges = distances_from(vertices, faces, start, end, 24, connectivity=6)
    result = distances_from(vertices, faces, start, end, 24)
    np.testing.assert_array_equal(np.isfinite(result), np.isfinite(edges))
    reached = np.isfinite(result)
    straight = distance_to_segment(vertices, start, end)
    assert (result[reached] >= straight[reached] * (1 - 1e-12)).all()
    # Paths start from more points of the bone, and need no more than the edges' length; but if
    # a bone is outside, they start behind the surface that faces it, a cell away at most.
    # In soups the bone is hardly ever inside; of the grid soup, 14 vertices are reached.
    longer = result[reached] > edges[reached] * (1 + 1e-12)
    share = 0.01 if name in ("box", "ball", "tube", "holes") else 0.4
    assert longer.mean() < share
    assert (result[reached] <= edges[reached] + 1 / 24).all()


def test_walls_are_not_seen_through():
    # A bar folded double: its ends lie next to each other, the way round is long.
    vertices, faces = l_bar()
    folded = np.array(
        [[0, 0], [1, 0], [1, 0.45], [0.2, 0.45], [0.2, 0.55], [1, 0.55], [1, 1], [0, 1]]
    )
    path = trimesh.creation.extrude_triangulation(
        folded,
        np.array([[0, 1, 2], [0, 2, 3], [0, 3, 4], [0, 4, 7], [4, 5, 6], [4, 6, 7]]),
        height=0.3,
    )
    for _ in range(3):
        path = path.subdivide()
    vertices, faces = np.array(path.vertices), np.array(path.faces, np.int32)
    start = np.array([0.95, 0.4, 0.15])
    result = distances_from(vertices, faces, start, start, 48)
    across = (vertices[:, 1] > 0.6) & (vertices[:, 0] > 0.8)
    way_round = 0.75 + 0.6  # to the inner corner and back, at the very least
    assert result[across].min() > way_round


@pytest.mark.parametrize("resolution", [32, 48, 64, 80, 96])
def test_nothing_is_seen_across_a_gap_thinner_than_a_cell(resolution):
    """Two prongs 0.01 apart: from the tip of one the other's bone is around the corner."""
    rig = fork()
    graph = build_graph(rig.mesh, resolution, connectivity="any")
    distance = bone_distances(graph, rig.skeleton).joint
    x, y = rig.mesh.vertices[:, :2].T
    tip = (x > 0.99) & (y < 0.11)
    assert (distance[4, tip] > 0.45).all()
    assert (distance[2, tip] < 0.12).all()


def chain_in_the_l():
    """Put twelve joints, one of them forked, into both arms of the L-bar."""
    vertices, faces = l_bar()
    lower = [[x, 0.12, 0.12] for x in np.linspace(0.9, 0.15, 6)]
    upper = [[0.13, y, 0.12] for y in np.linspace(0.3, 0.9, 5)]
    skeleton = Skeleton([*lower, *upper, [0.5, 0.2, 0.2]], [*range(-1, 10), 2])
    return build_graph(TriangleMesh(vertices, faces), 24, connectivity="any"), skeleton


@pytest.mark.parametrize("nearest", [1, 3, 5])
def test_the_nearest_joints_are_those_of_all(nearest):
    graph, skeleton = chain_in_the_l()
    every = bone_distances(graph, skeleton).joint
    few = bone_distances(graph, skeleton, nearest_joints=nearest)
    assert few.nearest_joints == nearest
    known = np.isfinite(few.joint).sum(axis=0)
    assert nearest <= known.min()
    assert known.max() == 2 * nearest
    result, expected = (np.sort(d, axis=0)[:nearest] for d in (few.joint, every))
    # Where a joint is just about to be too far, what lies beside the line of sight may not
    # know it any more: such paths bend a little.
    error = np.abs(result / expected - 1)
    assert (error < 1e-9).mean() > 0.95
    assert error.mean() < 1e-3
    assert error.max() < 0.15


def test_a_field_has_values_at_contracted_nodes():
    graph = build_graph(TriangleMesh(*meshes.ball(3)), 24, connectivity="any")
    start, end = np.array([[0.4, 0.5, 0.45], [0.6, 0.5, 0.5]])
    field = bone_distances(graph, Skeleton([start, end], [-1, 0])).field(0)
    start, end = graph.lattice.to_unit(np.array([start, end]))
    straight = distance_to_segment(graph.nodes, start, end)
    nodes = np.arange(len(graph.nodes))
    contracted = contract(graph).representative(nodes) != nodes
    assert contracted.sum() > 1000
    np.testing.assert_allclose(field[contracted], straight[contracted], rtol=1e-9)
    assert (field >= straight * (1 - 1e-9)).all()


def test_with_three_joints_for_certain_the_fourth_is_hardly_ever_missed():
    rig = load(demo_path("biped"))
    graph = build_graph(rig.mesh, 32, connectivity="any")
    every, few = (
        bone_distances(graph, rig.skeleton, leaf="fit", nearest_joints=n).joint for n in (None, 3)
    )
    fourth, result = (np.sort(distance, axis=0)[3] for distance in (every, few))
    assert (result <= fourth * 1.01).mean() > 0.97


def test_some_joints_are_measured_where_no_other_is_much_nearer():
    graph, skeleton = chain_in_the_l()
    bones = bone_distances(graph, skeleton).bones
    contraction = contract(graph)
    sources = find_sources(graph, bones, 5, NodeGrid.of(graph), contraction)
    nodes = contraction.node
    every = to_dense(any_angle_paths(graph, contraction, sources, bones, nodes)).T
    least = least_distances(graph, contraction, sources, bones)
    error = np.abs(least / every.min(axis=0) - 1)
    assert (error < 1e-9).mean() > 0.95
    assert error.mean() < 1e-3
    assert error.max() < 0.2

    some = np.isin(bones.joint, (2, 7))
    mine = sources.subset(some), bones.subset(some), nodes
    rows = any_angle_paths(graph, contraction, *mine, nearest=2, within=1.5, least=least)
    result = to_dense(rows).T
    near = every[[2, 7]] <= 1.5 * np.maximum(least, 0.5 / 24)
    assert 0.1 < near.mean() < 0.5
    assert (np.isfinite(result) == near).mean() > 0.99
    both = near & np.isfinite(result)
    assert (np.abs(result / every[[2, 7]] - 1)[both] < 1e-9).mean() > 0.95


def test_distances_do_not_depend_on_how_vertices_are_numbered():
    rig = load(demo_path("biped"))
    graph = build_graph(rig.mesh, 24, connectivity="any")
    bones = bone_distances(graph, rig.skeleton).bones
    by_graph = contract(graph)
    by_place = _sorted_by_place(by_graph, graph.first_point)
    assert (by_place.node != by_graph.node).mean() > 0.1
    assert (by_place.node[by_place.number] == by_graph.node[by_graph.number]).all()
    nodes = np.arange(graph.first_point, dtype=np.int32)

    def measured(contraction):
        sources = find_sources(graph, bones, 5, NodeGrid.of(graph), contraction)
        least = least_distances(graph, contraction, sources, bones)[contraction.number]
        few = any_angle_paths(graph, contraction, sources, bones, nodes, nearest=3, within=6)
        return least, to_dense(few)

    for expected, result in zip(measured(by_graph), measured(by_place), strict=True):
        np.testing.assert_array_equal(result, expected)


def test_what_is_many_times_farther_than_the_nearest_is_left_out():
    vertices, faces = meshes.ball(3)
    skeleton = Skeleton([[0.5, 0.5, 0.15 * k] for k in range(1, 7)], range(-1, 5))
    graph = build_graph(TriangleMesh(vertices, faces), 16, connectivity="any")
    some, near = (
        bone_distances(graph, skeleton, nearest_joints=4, within=w).joint for w in (np.inf, 1.5)
    )
    kept = np.isfinite(near)
    np.testing.assert_allclose(near[kept], some[kept], rtol=1e-9)
    limit = 1.5 * np.maximum(some.min(axis=0), 0.5 / 16)
    assert (some[kept] <= np.broadcast_to(limit, some.shape)[kept]).all()
    assert (kept == (some <= limit)).mean() > 0.99  # a way round may lead past the limit
    assert kept.sum() < np.isfinite(some).sum()
    # Only who knows all joints can tell which is the nearest.
    whole = bone_distances(graph, skeleton, nearest_joints=6, within=1.5).joint
    assert np.isfinite(whole).all()
    with pytest.raises(ParameterError, match="within must be a number from 1"):
        bone_distances(graph, skeleton, nearest_joints=4, within=0.5)


def test_all_joints_are_measured_where_as_many_are_wanted():
    graph, skeleton = chain_in_the_l()
    every = bone_distances(graph, skeleton)
    assert np.isfinite(every.joint).all()
    enough = bone_distances(graph, skeleton, nearest_joints=12)
    np.testing.assert_array_equal(enough.joint, every.joint)
    # Joint by joint, as `field` does it, gives the same as all together.
    for joint in (0, 2, 7):
        alone = every.field(joint)[graph.vertex_node]
        np.testing.assert_allclose(alone, every.joint[joint], rtol=1e-9)
    few = bone_distances(graph, skeleton, nearest_joints=2)
    np.testing.assert_array_equal(few.on_mesh(7), every.on_mesh(7))
    np.testing.assert_array_equal(few.of_all_joints().joint, every.joint)
    assert every.of_all_joints() is every
    with pytest.raises(ParameterError, match="nearest_joints must be a whole number from 1"):
        bone_distances(graph, skeleton, nearest_joints=0)


def test_neighbours_are_in_different_parts():
    chain = np.arange(9.0)[:, None] * [1, 0, 0]
    even = np.arange(9) % 2 == 0
    np.testing.assert_array_equal(partition_sources(chain), [even, ~even])
    np.testing.assert_array_equal(
        partition_sources(np.zeros((2, 3))), [[True, False], [False, True]]
    )
    np.testing.assert_array_equal(partition_sources(np.zeros((1, 3))), [[True]])


def test_distances_repeat_to_the_last_bit():
    graph, skeleton = chain_in_the_l()
    once, again = (bone_distances(graph, skeleton, nearest_joints=4).joint for _ in range(2))
    np.testing.assert_array_equal(once, again)


def test_what_lies_beyond_the_last_bucket_is_reached_in_order():
    # Paths longer than the span that buckets are made for.
    turns, thin = 9, 0.04
    y = np.arange(turns) * 2 * thin
    corners = [[0, 0]]
    x = 0.0
    for k in range(turns):
        x = 1.0 - x
        corners += [[x, y[k]], [x, y[k] + 2 * thin]] if k < turns - 1 else [[x, y[k]]]
    tube = ribbon(np.array(corners), 0.6 * thin)
    start = np.array([0.02, 0, 0])
    result = distances_from(*tube, start, start, 96)
    assert np.isfinite(result).all()
    assert result.max() > 1.0 * (SPAN + 1)


def ribbon(corners, half):
    """Extrude a polyline of axis-parallel pieces into a duct with square cross-sections."""
    boxes = []
    for a, b in itertools.pairwise(corners):
        low, high = np.minimum(a, b) - half, np.maximum(a, b) + half
        box = trimesh.creation.box(bounds=[[*low, -half], [*high, half]])
        boxes.append(box)
    mesh = trimesh.util.concatenate(boxes)
    return np.array(mesh.vertices), np.array(mesh.faces, np.int32)
