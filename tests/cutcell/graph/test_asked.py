"""Answers about midpoints are those of the exact sum, however many are asked about at once."""

import numpy as np
import pytest

from cutcell.graph.asked import UNTOLD, answer
from cutcell.graph.boundary import find_boundary
from cutcell.graph.caps import cap_holes
from cutcell.graph.doubt import BLOCK
from cutcell.graph.holes import find_doubt
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


def questions(doubt, each, rng):
    """Choose leaves, and queries in the cells of each; those of one leaf not in a row."""
    leaf = np.unique(doubt.fine[doubt.fine >= 0])
    leaf = rng.permutation(np.repeat(rng.permutation(leaf)[:40], each)).astype(np.int32)
    points = doubt.leaves.place[leaf] + rng.uniform(-1, 1, (len(leaf), 3)) / RESOLUTION
    return leaf, np.column_stack([points, rng.integers(-1, 3, len(leaf)) - TAU])


@pytest.mark.parametrize("each", [1, 17])
@pytest.mark.parametrize("name", SHAPES)
def test_answers_are_those_of_the_exact_sum(name, each):
    vertices, faces = SHAPES[name]()
    low, side = vertices.min(axis=0), np.ptp(vertices, axis=0).max()
    vertices = (vertices - low) / side * 0.9 + 0.05
    caps = cap_holes(vertices, faces, find_boundary(faces))
    doubt = find_doubt(caps, RESOLUTION, TAU)
    leaf, queries = questions(doubt, each, np.random.default_rng(1))
    assert len(leaf) >= each
    told = []
    found = answer(doubt, leaf, queries, told.append)
    assert told[-1] == 1
    inside = queries[:, 3] - naive.winding_number(caps.vertices, caps.faces, queries[:, :3])
    is_plain = np.abs(inside) > 1e-6
    assert is_plain.mean() > 0.9
    np.testing.assert_array_equal(found[is_plain], inside[is_plain] > 0)
    # What one asks does not hang on what others ask.
    some = np.flatnonzero(np.random.default_rng(2).random(len(leaf)) < 0.3)
    np.testing.assert_array_equal(answer(doubt, leaf[some], queries[some]), found[some])


def test_many_portions_give_what_one_does(monkeypatch):
    vertices, faces = torn_ball(0.2)
    doubt = find_doubt(cap_holes(vertices, faces, find_boundary(faces)), RESOLUTION, TAU)
    leaf, queries = questions(doubt, 300, np.random.default_rng(1))  # more than are seen at once
    found = answer(doubt, leaf, queries)
    told = []
    monkeypatch.setattr("cutcell.graph.asked.A_WHILE", 1)
    np.testing.assert_array_equal(answer(doubt, leaf, queries, told.append), found)
    assert len(told) > 20


def test_a_midpoint_on_a_cap_is_left_to_the_exact_sum():
    vertices, faces = torn_ball(0.2)
    caps = cap_holes(vertices, faces, find_boundary(faces))
    doubt = find_doubt(caps, RESOLUTION, TAU)
    spots = np.einsum("c,tci->ti", [0.4, 0.35, 0.25], caps.vertices[caps.faces])
    cell = (spots * RESOLUTION).astype(int)
    block = doubt.coarse[tuple(cell.T // BLOCK)]
    leaf = np.where(block >= 0, doubt.fine[block, *(cell.T % BLOCK)], -1)
    assert (leaf >= 0).sum() > 100
    # What the triangle itself covers there is a half, on one side or on the other.
    queries = np.column_stack([spots, np.full(len(spots), 0.1)])[leaf >= 0]
    found = answer(doubt, leaf[leaf >= 0].astype(np.int32), queries)
    assert (found == UNTOLD).all()


def test_nothing_asked_is_nothing_answered():
    vertices, faces = torn_ball(0.2)
    caps = cap_holes(vertices, faces, find_boundary(faces))
    doubt = find_doubt(caps, RESOLUTION, TAU)
    assert len(answer(doubt, np.zeros(0, np.int32), np.zeros((0, 4)))) == 0
