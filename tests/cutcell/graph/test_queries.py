"""Point queries give what the exact sum gives, however many there are at once."""

import numpy as np
import pytest

from cutcell.graph.winding.boundary import find_boundary
from cutcell.graph.winding.treecode.caps import cap_holes
from cutcell.graph.winding.treecode.cells import BLOCK_CELLS, classify_cells
from cutcell.graph.winding.treecode.clusters import build_tree
from cutcell.graph.winding.treecode.queries import winding_numbers_of_caps
from tests import meshes, naive

RESOLUTION, TAU = 32, 0.5


def torn_ball(shrunk):
    """Take a ball's triangles apart."""
    vertices, faces = meshes.ball(3)
    corners = vertices[faces]
    middle = corners.mean(axis=1, keepdims=True)
    corners = middle + (1 - shrunk) * (corners - middle)
    return corners.reshape(-1, 3), np.arange(faces.size, dtype=np.int32).reshape(-1, 3)


def turned_ball():
    """Turn half of a ball's triangles round."""
    vertices, faces = meshes.ball(3)
    turned = np.random.default_rng(0).random(len(faces)) < 0.5
    return vertices, np.where(turned[:, None], faces[:, ::-1], faces)


SHAPES = {name: make for name, make in meshes.OPEN.items() if name != "degenerate"} | {
    "shrunk a little": lambda: torn_ball(0.01),
    "shrunk": lambda: torn_ball(0.2),
    "turned": turned_ball,
}


def classified(vertices, faces):
    """Return the caps of a mesh, their clusters, and the classes of cells."""
    caps = cap_holes(vertices, find_boundary(faces))
    clusters = build_tree(caps)
    return caps, clusters, classify_cells(clusters, RESOLUTION, TAU)


def some_queries(classes, each, rng):
    """Choose ambiguous blocks, points in the cells of each, and margins; shuffled."""
    row = np.unique(classes.fine[classes.fine >= 0])
    row = rng.permutation(np.repeat(rng.permutation(row)[:40], each)).astype(np.int32)
    points = classes.expansions.centre[row] + rng.uniform(-2, 2, (len(row), 3)) / RESOLUTION
    return row, points, rng.integers(-1, 3, len(row)) - TAU


@pytest.mark.parametrize("each", [1, 17])
@pytest.mark.parametrize("name", SHAPES)
def test_results_are_those_of_the_exact_sum(name, each):
    vertices, faces = SHAPES[name]()
    low, side = vertices.min(axis=0), np.ptp(vertices, axis=0).max()
    vertices = (vertices - low) / side * 0.9 + 0.05
    caps, clusters, classes = classified(vertices, faces)
    row, points, margin = some_queries(classes, each, np.random.default_rng(1))
    assert len(row) >= each
    values = winding_numbers_of_caps(classes.expansions, clusters, row, points, margin)
    expected = naive.winding_number(caps.vertices, caps.faces, points)
    distance = np.abs(margin - expected)
    is_plain = distance > 1e-6
    assert is_plain.mean() > 0.9
    assert (np.abs(values - expected) < distance)[is_plain].all()
    # The result of a query does not depend on the others.
    some = np.flatnonzero(np.random.default_rng(2).random(len(row)) < 0.3)
    queries = row[some], points[some], margin[some]
    alone = winding_numbers_of_caps(classes.expansions, clusters, *queries)
    np.testing.assert_array_equal(alone > margin[some], values[some] > margin[some])


def test_a_midpoint_on_a_cap_is_left_to_the_exact_sum():
    vertices, faces = torn_ball(0.2)
    caps, clusters, classes = classified(vertices, faces)
    spots = np.einsum("c,tci->ti", [0.4, 0.35, 0.25], caps.vertices[caps.faces])
    cell = (spots * RESOLUTION).astype(int)
    block = classes.coarse[tuple(cell.T // BLOCK_CELLS)]
    row = np.where(block >= 0, classes.fine[block, *(cell.T % BLOCK_CELLS)], -1)
    assert (row >= 0).sum() > 100
    # The winding number of the triangle itself is there one half, of either sign.
    queries = row[row >= 0].astype(np.int32), spots[row >= 0], np.full((row >= 0).sum(), 0.1)
    assert np.isnan(winding_numbers_of_caps(classes.expansions, clusters, *queries)).all()


def test_no_queries_have_no_results():
    vertices, faces = torn_ball(0.2)
    _, clusters, classes = classified(vertices, faces)
    nothing = np.zeros(0, np.int32), np.zeros((0, 3)), np.zeros(0)
    assert len(winding_numbers_of_caps(classes.expansions, clusters, *nothing)) == 0
