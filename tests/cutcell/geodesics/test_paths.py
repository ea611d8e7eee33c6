"""The way back from a vertex is as long as its distance, and stays inside."""

from itertools import pairwise

import numpy as np
import pytest

import cutcell
from cutcell import (
    ParameterError,
    Skeleton,
    TriangleMesh,
)
from cutcell.geodesics import PIECES, path_length, trace_path
from cutcell.geodesics.tracing.inside import SAMPLED_TOLERANCE
from cutcell_assets import demo_path
from cutcell_lab.benchmarks.paths import outside_by, samples_of
from tests import meshes
from tests.cutcell.animation.test_any_angle import l_bar
from tests.paper import bone_distances, build_graph

SKELETON = Skeleton([[0.9, 0.1, 0.12], [0.8, 0.1, 0.12]], [-1, 0], deform=[True, False])


def measured(connectivity, skeleton=SKELETON, resolution=24):
    mesh = TriangleMesh(*l_bar())
    graph = build_graph(mesh, resolution, connectivity=connectivity)
    return mesh, bone_distances(graph, skeleton)


@pytest.mark.parametrize("connectivity", [6, 26])
def test_along_edges_it_is_exactly_as_long_as_the_field_says(connectivity):
    mesh, distances = measured(connectivity)
    field = distances.field(0)
    for vertex in range(0, len(mesh.vertices), 97):
        path = trace_path(distances, 0, vertex, field).points
        assert path_length(path) == pytest.approx(
            field[distances.graph.vertex_node[vertex]], rel=5e-3
        )


def test_at_any_angle_it_bends_only_at_corners_and_stays_inside():
    _, distances = measured("any")
    graph, field = distances.graph, distances.field(0)
    far = np.argsort(-field[graph.vertex_node])[: len(graph.vertex_node) // 2 : 41]
    for vertex in far:
        path = trace_path(distances, 0, int(vertex), field).points
        assert path_length(path) == pytest.approx(field[graph.vertex_node[vertex]], rel=0.13)
        assert len(path) <= 9
        steps = np.linspace(0, 1, 19)[:, None, None]
        between = (path[:-1] + steps * (path[1:] - path[:-1])).reshape(-1, 3)
        # Nowhere near the air that the L leaves out.
        x, y = graph.lattice.to_file(between)[:, :2].T
        assert np.minimum(x, y).max() < 0.25 + 1 / 24


def test_it_begins_at_the_vertex_and_ends_on_the_bone():
    mesh, distances = measured("any")
    path = trace_path(distances, 0, 5).points
    np.testing.assert_allclose(distances.graph.lattice.to_file(path[0]), mesh.vertices[5])
    foot = distances.graph.lattice.to_file(path[-1])
    np.testing.assert_allclose(foot[1:], [0.1, 0.12], atol=1e-9)
    assert 0.8 - 1e-9 <= foot[0] <= 0.9 + 1e-9


def test_where_no_path_leads_there_is_none():
    (v, f), (w, g) = meshes.box(0, 0.4), meshes.box(0.6, 1)
    mesh = TriangleMesh(np.concatenate([v, w]), np.concatenate([f, g + len(v)]))
    distances = bone_distances(build_graph(mesh, 10), Skeleton([[0.2, 0.2, 0.2]], [-1]))
    assert trace_path(distances, 0, len(v)).points.shape == (0, 3)


def test_what_there_is_not_is_refused():
    _, distances = measured(6, resolution=8)
    with pytest.raises(ParameterError, match="vertex"):
        trace_path(distances, 0, 10**6)
    with pytest.raises(ParameterError, match="no bone"):
        trace_path(distances, 1, 0)
    with pytest.raises(ParameterError, match="field has the shape"):
        trace_path(distances, 0, 0, np.zeros(3))


@pytest.mark.parametrize(
    ("demo", "connectivity"), [("biped", 6), ("biped", "any"), ("biped_soup", 26)]
)
def test_no_piece_leaves_the_body_by_half_a_cell(demo, connectivity):
    rig = cutcell.load(demo_path(demo))
    graph = cutcell.build_graph(rig.mesh, 32, connectivity=connectivity)
    distances = cutcell.bone_distances(graph, rig.skeleton, leaf="fit")
    rng = np.random.default_rng(3)
    for joint in rng.choice(np.unique(distances.bones.joint), 4).tolist():
        field = distances.field(joint)
        reached = np.flatnonzero(np.isfinite(field[graph.vertex_node]))
        for vertex in rng.choice(reached, 8).tolist():
            path = trace_path(distances, joint, vertex, field)
            points, kinds = samples_of(path, 32)
            away = outside_by(distances, points)[kinds != PIECES.index("outside")]
            assert away.max() <= SAMPLED_TOLERANCE < 0.5
            assert path.length >= np.linalg.norm(path.points[-1] - path.points[0]) - 1e-12


def test_pieces_are_told_by_what_they_are():
    _, distances = measured(6)
    graph, vertex = distances.graph, 97
    path = trace_path(distances, 0, vertex)
    kinds: dict[frozenset, set[int]] = {}  # by position: nodes may share one
    for edge, kind in zip(graph.edges, graph.edge_kind, strict=True):
        kinds.setdefault(frozenset(map(tuple, graph.nodes[edge])), set()).add(int(kind))
    for piece, kind in zip(pairwise(map(tuple, path.points[:-1])), path.kinds[:-1], strict=True):
        assert kind in kinds[frozenset(piece)]
    assert PIECES[path.kinds[-1]] == "line of sight"


def test_the_way_to_a_bone_outside_of_the_body_is_told_as_outside():
    above = Skeleton([[0.9, 0.1, 1.0], [0.8, 0.1, 1.0]], [-1, 0], deform=[True, False])
    for connectivity in (6, "any"):
        _, distances = measured(connectivity, above)
        path = trace_path(distances, 0, 5)
        assert PIECES[path.kinds[-1]] == "outside"
        assert np.count_nonzero(path.kinds == PIECES.index("outside")) == 1
