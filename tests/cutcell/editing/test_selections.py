"""Selections along the mesh, against sets of neighbours."""

import numpy as np
import pytest

from cutcell.editing.selections import Neighbours
from cutcell.rig import TriangleMesh
from tests.bars import grid_box


@pytest.fixture(scope="module")
def split():
    """Return two boxes, each triangle with corners of its own, in a random order."""
    points, faces = grid_box(6)
    other, _ = grid_box(3)
    corners = points[faces].reshape(-1, 3)
    more = other[grid_box(3)[1]].reshape(-1, 3) + np.array([0, 5, 0])
    order = np.random.default_rng(0).permutation(len(corners) + len(more))
    vertices = np.concatenate([corners, more])[order]
    index = np.argsort(order).reshape(-1, 3)
    return TriangleMesh(vertices, index)


def by_sets(mesh):
    """Return the place of each vertex, and the places next to each place."""
    place = [tuple(np.round(vertex, 6)) for vertex in mesh.vertices]
    next_to = {one: {one} for one in place}
    for face in mesh.faces:
        for a in face:
            next_to[place[a]] |= {place[b] for b in face}
    return place, next_to


def test_grow_and_shrink_are_those_of_places(split):
    neighbours, (place, next_to) = Neighbours.of(split), by_sets(split)
    random = np.random.default_rng(1)
    for share in (0.02, 0.3, 0.9):
        chosen = random.random(len(place)) < share
        places = {one for one, on in zip(place, chosen, strict=True) if on}
        grown = set().union(*(next_to[one] for one in places))
        shrunk = {one for one in places if next_to[one] <= places}
        assert np.array_equal(neighbours.grown(chosen), [one in grown for one in place])
        assert np.array_equal(neighbours.shrunk(chosen), [one in shrunk for one in place])


def test_shrinking_undoes_growing_no_farther_than_it_was(split):
    neighbours = Neighbours.of(split)
    for seed in range(5):
        chosen = np.random.default_rng(seed).random(len(split.vertices)) < 0.05
        whole = neighbours.shrunk(neighbours.grown(chosen))
        assert whole[chosen].all()
        opened = neighbours.grown(neighbours.shrunk(chosen))
        assert not (opened & ~neighbours.grown(neighbours.shrunk(neighbours.grown(chosen)))).any()
    nothing = np.zeros(len(split.vertices), bool)
    assert not neighbours.grown(nothing).any()
    assert neighbours.shrunk(~nothing).all()


def test_components_are_numbered_from_the_largest(split):
    component = split.welded.component[split.welded.index]
    assert np.array_equal(component, split.vertices[:, 1] > 2)


def test_dilated_strengths_are_the_largest_of_places_around(split):
    neighbours, (place, next_to) = Neighbours.of(split), by_sets(split)
    values = np.random.default_rng(2).random(len(place))
    at = {}
    for one, value in zip(place, values, strict=True):
        at[one] = max(at.get(one, 0.0), value)
    expected = [max(at[other] for other in next_to[one]) for one in place]
    np.testing.assert_array_equal(neighbours.dilated(values), expected)
