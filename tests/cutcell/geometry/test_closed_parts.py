"""Closed parts stay apart where they touch; open ones are welded to whatever they touch."""

import numpy as np
import pytest
from scipy.sparse.csgraph import connected_components

from cutcell import TriangleMesh, build_graph
from cutcell.geometry.edges import find_edges
from tests import meshes
from tests.bars import grid_box


def joined(*parts):
    shift = np.cumsum([0, *(len(vertices) for vertices, _ in parts)])
    return (
        np.concatenate([vertices for vertices, _ in parts]),
        np.concatenate([faces + n for (_, faces), n in zip(parts, shift, strict=False)]),
    )


def at(part, x, y=0.0, z=0.0):
    return part[0] + [x, y, z], part[1]


def split(part):
    """Give each face vertices of its own, as files with flat normals do."""
    vertices, faces = part
    return vertices[faces].reshape(-1, 3), np.arange(faces.size).reshape(-1, 3)


def cube(count=2, size=1.0):
    return grid_box(count, count, count, (size,) * 3)


def opened(part):
    """Remove the wall at x = 0."""
    vertices, faces = part
    return vertices, faces[vertices[faces][:, :, 0].max(axis=1) > 0]


def bodies(mesh):
    graph = build_graph(TriangleMesh(*mesh), 16)
    return connected_components(graph.csr(), directed=False)[0]


FLUSH = {
    "along a wall": [(0, 0, 0), (1, 0, 0)],
    "along an edge": [(0, 0, 0), (1, 1, 0)],
    "at a corner": [(0, 0, 0), (1, 1, 1)],
    "four around an edge": [(0, 0, 0), (1, 0, 0), (0, 1, 0), (1, 1, 0)],
    "a row": [(0, 0, 0), (1, 0, 0), (2, 0, 0)],
}


@pytest.mark.parametrize("change", [lambda part: part, split], ids=["whole", "split"])
@pytest.mark.parametrize("where", FLUSH)
def test_closed_parts_that_touch_are_as_many_bodies(where, change):
    places = FLUSH[where]
    parts = [change(at(cube(), *place)) for place in places]
    assert bodies(joined(*parts)) == len(places)
    vertices, faces = joined(*parts)
    assert bodies((vertices, faces[:, ::-1])) == len(places), "inverted as a whole"
    order = np.random.default_rng(0).permutation(len(faces))
    assert bodies((vertices, faces[order])) == len(places)


def test_walls_need_not_have_the_same_vertices():
    arm = cube(3, 0.5)
    turn = np.linalg.qr(np.random.default_rng(1).normal(size=(3, 3)))[0]
    vertices, faces = joined(cube(), at(arm, 1, 0.2, 0.3))
    assert bodies((vertices, faces)) == 2
    assert bodies((vertices @ turn, faces)) == 2, "where rounding differs from wall to wall"


def test_open_parts_are_welded():
    lid_off = at(opened(cube()), 1)
    assert bodies(joined(cube(), lid_off)) == 1
    assert bodies(joined(split(cube()), split(lid_off))) == 1
    vertices, faces = opened(cube())
    halves = joined((vertices, faces), (vertices * [-1, 1, 1], faces[:, ::-1]))
    graph = build_graph(TriangleMesh(*halves), 16)
    assert graph.is_closed
    assert graph.first_point == len(vertices) * 2 - 9


def test_parts_that_overlap_are_one_body():
    assert bodies(joined(cube(), at(cube(), 0.9))) == 1


def test_a_mesh_of_one_part_is_welded_as_before():
    for name in ("torus", "ball", "holes", "tube", "non-manifold"):
        vertices, faces = meshes.ALL[name]()
        graph = build_graph(TriangleMesh(*split((vertices, faces))), 8)
        assert graph.first_point == len(np.unique(faces))


def test_vertices_of_no_face_have_the_node_of_their_place():
    vertices, faces = joined(cube(), at(cube(), 1))
    unused = np.concatenate([vertices, vertices[:9], [[0.3, 0.3, 0.3]]])
    graph = build_graph(TriangleMesh(unused, faces), 8)
    assert graph.first_point == len(vertices) + 1
    back = graph.lattice.to_file(graph.nodes[graph.vertex_node])
    np.testing.assert_allclose(back, unused, atol=1e-9)


def test_each_part_is_closed_once_they_are_apart():
    vertices, faces = joined(*(at(cube(), *place) for place in FLUSH["four around an edge"]))
    graph = build_graph(TriangleMesh(vertices, faces), 8)
    assert (find_edges(graph.faces).partner >= 0).all()
