"""One slice of the lattice tells what the graph was built from."""

import numpy as np
import pytest

from cutcell import ParameterError, TriangleMesh, build_graph, winding_number
from cutcell.graph import INTERIOR
from cutcell_viewers.ray_slice import slice_rays
from tests import meshes


def middles_in(graph, axis, normal, index):
    """Midpoints of the graph's interior edges that lie in a slice and run along an axis."""
    ends = graph.nodes[graph.edges[graph.edge_kind == INTERIOR]]
    level = (index + 0.5) / graph.lattice.resolution
    inside = (np.abs(ends[:, :, normal] - level) < 1e-9).all(axis=1)
    other = 3 - axis - normal
    along = np.abs(ends[:, 0, other] - ends[:, 1, other]) < 1e-12
    moves = np.abs(ends[:, 0, axis] - ends[:, 1, axis]) > 1e-12
    return ends[inside & along & moves].mean(axis=1)


@pytest.mark.parametrize("shape", [meshes.ball, meshes.torus, meshes.ball_with_holes, meshes.tube])
@pytest.mark.parametrize(("axis", "normal"), [(0, 1), (0, 2), (1, 0), (2, 0), (2, 1)])
def test_kept_segments_are_the_graphs_interior_edges(shape, axis, normal):
    mesh = TriangleMesh(*shape())
    graph = build_graph(mesh, 12, connectivity=6)
    result = slice_rays(mesh, 12, axis=axis, normal=normal, index=5)
    long = np.linalg.norm(result.high - result.low, axis=1) > 1e-12
    kept = ((result.low + result.high) / 2)[result.inside & long]
    expected = middles_in(graph, axis, normal, 5)
    assert len(expected) > 0
    order = lambda points: points[np.lexsort(points.round(9).T)]  # noqa: E731
    np.testing.assert_allclose(order(kept), order(expected), atol=1e-9)


def test_segments_hang_together_and_tell_their_winding_number():
    mesh = TriangleMesh(*meshes.ball_with_holes())
    result = slice_rays(mesh, 10, axis=2, normal=0, index=4, winding_threshold=0.3)
    assert (result.high[:, 2] > result.low[:, 2]).all()
    np.testing.assert_allclose(result.low[:, 0], 0.45)
    middle = result.lattice.to_file((result.low + result.high) / 2)
    np.testing.assert_allclose(result.winding, winding_number(mesh, middle), atol=1e-12)
    np.testing.assert_array_equal(result.inside, result.winding >= 0.3)
    assert 0 < result.inside.sum() < len(result.inside)


def test_on_a_closed_mesh_each_ray_enters_as_often_as_it_leaves():
    mesh = TriangleMesh(*meshes.torus())
    result = slice_rays(mesh, 16, axis=0, normal=2, index=8)
    assert result.sign.sum() == 0
    np.testing.assert_allclose(result.winding, result.winding.round(), atol=1e-9)
    corners = result.lattice.to_unit(mesh.vertices)[mesh.faces[result.triangle]]
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    np.testing.assert_array_equal(np.sign(normal[:, 0]), result.sign)
    offset = ((result.crossing - corners[:, 0]) * normal).sum(axis=1)
    np.testing.assert_allclose(offset, 0, atol=1e-12)


@pytest.mark.parametrize(
    ("wrong", "said"),
    [
        ({"normal": 0}, "both 0"),
        ({"axis": 3}, "axis"),
        ({"index": 8}, "index"),
        ({"winding_threshold": 2}, "winding_threshold"),
    ],
)
def test_a_slice_that_is_none_is_refused(wrong, said):
    mesh = TriangleMesh(*meshes.box())
    with pytest.raises(ParameterError, match=said):
        slice_rays(mesh, 8, **{"axis": 0, "normal": 1, "index": 0, **wrong})


@pytest.mark.parametrize(
    ("module", "libraries"),
    [("embreex", {"rays": "embree"}), ("open3d", {"rays": "open3d"}), ("igl", {"winding": "fast"})],
)
def test_libraries_decide_a_closed_mesh_alike(module, libraries):
    pytest.importorskip(module, reason=f"{module} is not installed", exc_type=ImportError)
    mesh = TriangleMesh(*meshes.ball())
    own, other = (slice_rays(mesh, 12, axis=0, normal=2, index=6, **by) for by in ({}, libraries))
    assert own.inside.any()
    assert not own.decided_otherwise(other).any()
    assert not other.decided_otherwise(own).any()


def test_segments_that_another_threshold_decides_otherwise_are_named():
    mesh = TriangleMesh(*meshes.ball_with_holes())
    low, high = (
        slice_rays(mesh, 12, axis=1, normal=2, index=6, winding_threshold=tau) for tau in (0.3, 0.9)
    )
    differs = low.decided_otherwise(high)
    assert differs.any()
    np.testing.assert_array_equal(differs, (low.winding >= 0.3) & (low.winding < 0.9))
