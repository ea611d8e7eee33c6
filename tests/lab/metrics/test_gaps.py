"""Gaps are found where parts of a body nearly touch, and what weight is shared across them."""

import numpy as np
import pytest

from cutcell import ParameterError, TriangleMesh
from cutcell.graph import build_graph
from cutcell_lab.metrics import crosstalk, find_gaps
from tests import meshes


def horseshoe(gap=0.02):
    """Make a U of boxes whose arms nearly touch, 0.8 long."""
    cells = {}
    xs, ys = np.linspace(0, 1, 21), [0, 0.1, 0.1 + gap, 0.2 + gap]
    solid = np.ones((20, 3), bool)
    solid[2:, 1] = False
    quads = []

    def corner(i, j, k):
        return cells.setdefault((i, j, k), len(cells))

    for i, j in np.argwhere(solid):
        for k, flip in ((0, True), (1, False)):
            quad = [(i, j, k), (i + 1, j, k), (i + 1, j + 1, k), (i, j + 1, k)]
            quads.append(quad[::-1] if flip else quad)
        for (di, dj), (a, b) in {
            (-1, 0): ((0, 1), (0, 0)),
            (1, 0): ((1, 0), (1, 1)),
            (0, -1): ((0, 0), (1, 0)),
            (0, 1): ((1, 1), (0, 1)),
        }.items():
            u, v = i + di, j + dj
            if 0 <= u < 20 and 0 <= v < 3 and solid[u, v]:
                continue
            p, q = (i + a[0], j + a[1]), (i + b[0], j + b[1])
            quads.append([(*p, 0), (*q, 0), (*q, 1), (*p, 1)])
    faces = []
    for quad in quads:
        a, b, c, d = (corner(*at) for at in quad)
        faces += [[a, b, c], [a, c, d]]
    vertices = np.array([[xs[i], ys[j], 0.3 * k] for i, j, k in cells])
    return TriangleMesh(vertices, faces)


def test_gaps_are_found_where_arms_nearly_touch():
    mesh = horseshoe()
    graph = build_graph(mesh, 64)
    assert graph.is_closed
    pairs = find_gaps(graph, near=0.03, far=0.3)
    assert len(pairs) > 10
    sides = mesh.vertices[pairs][:, :, 1]
    assert ((sides.min(axis=1) <= 0.1 + 1e-9) & (sides.max(axis=1) >= 0.12 - 1e-9)).all()
    assert mesh.vertices[pairs][:, :, 0].min() > 0.15  # where the arms meet is no gap

    upper = mesh.vertices[:, 1] > 0.11
    apart = np.stack([upper, ~upper], axis=1).astype(float)
    assert crosstalk(apart, pairs).mean == 0
    assert crosstalk(np.full((len(upper), 2), 0.5), pairs).mean == pytest.approx(1)
    few = find_gaps(graph, near=0.03, far=0.3, searches=3)
    assert 0 < len(few) < len(pairs)


def test_a_ball_has_no_gap():
    pairs = find_gaps(build_graph(TriangleMesh(*meshes.ball(2)), 16))
    assert pairs.shape == (0, 2)
    assert np.isnan(crosstalk(np.ones((162, 1)), pairs).mean)


def test_a_search_for_gaps_needs_sense():
    graph = build_graph(TriangleMesh(*meshes.ball(1)), 8)
    with pytest.raises(ParameterError, match="far must be"):
        find_gaps(graph, near=0.5, far=0.1)


@pytest.mark.parametrize(
    ("pairs", "words"), [([[0, 1, 2]], "expected \\(p, 2\\)"), ([[0, 99]], "beyond")]
)
def test_pairs_are_of_vertices_with_weights(pairs, words):
    with pytest.raises(ParameterError, match=words):
        crosstalk(np.ones((3, 1)), pairs)
