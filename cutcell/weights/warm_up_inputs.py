"""Small inputs that take every path through a binding, so that all of it is compiled."""

from __future__ import annotations

import numpy as np

from ..geometry.welded import WeldedMesh
from ..graph import INTERIOR, MESH, CutCellGraph, Lattice
from ..graph.interior import InteriorPoints
from ..rig import Skeleton, TriangleMesh

AROUND = 16
"""Vertices around the tube: its open ends are holes too wide for a few triangles."""
MISSING = 5, 25, 45, 65, 85
"""Faces of the tube that leave small holes: enough holes for a tree of them."""
TETRAHEDRON = np.array([[0.3, 0, 0.5], [0.35, 0, 0.5], [0.3, 0.05, 0.5], [0.3, 0, 0.55]])
"""Beside the tube: there is work for several components only. It is inside out."""
MOEBIUS_BAND = np.array(
    [[0.3, 0, 0.1], [0.3, 0, 0.2], [0.4, 0, 0.15], [0.4, 0.1, 0.1], [0.3, 0.1, 0.15]]
)
"""Five faces that cannot be oriented consistently."""
SIDE = 8
"""Lattice points along each side of the block."""


def tube() -> TriangleMesh:
    """Return a tube with holes, and beside it a tetrahedron and a Moebius band."""
    turn = np.linspace(0, 2 * np.pi, AROUND, endpoint=False)
    heights = np.linspace(0, 1, 5)
    rings = [np.stack([np.cos(turn) / 5, np.sin(turn) / 5, np.full(AROUND, z)], 1) for z in heights]
    vertex = np.arange((len(heights) - 1) * AROUND)
    after = vertex // AROUND * AROUND + (vertex + 1) % AROUND
    faces = [[vertex, after, after + AROUND], [vertex, after + AROUND, vertex + AROUND]]
    whole = np.concatenate([np.stack(face, axis=1) for face in faces])
    cut = np.delete(whole, MISSING, axis=0)
    count = len(rings) * AROUND
    tetrahedron = np.array([[0, 1, 2], [0, 3, 1], [0, 2, 3], [1, 3, 2]]) + count
    band = (np.arange(5)[:, None] + np.arange(3)) % 5 + count + len(TETRAHEDRON)
    vertices = np.concatenate([*rings, TETRAHEDRON, MOEBIUS_BAND])
    return TriangleMesh(vertices, np.concatenate([cut, tetrahedron, band]))


def chain() -> Skeleton:
    """Return more joints than a vertex has distances of.

    The last is so far away that its labels outlast the queue's buckets.
    """
    joints = np.zeros((8, 3))
    joints[:, 2] = np.linspace(0.1, 0.9, 8)
    joints[-1] = 3
    return Skeleton(joints, np.array([*range(-1, 6), -1]))


def block_graph(connectivity: int | str = "any") -> CutCellGraph:
    """Make a graph of the tube without `build_graph`, so that nothing has to be compiled for it.

    All lattice points of the cube are taken to lie inside, and no ray to hit the surface: each
    vertex has an edge to the lattice point that is nearest.
    """
    mesh = tube()
    lattice, first = Lattice.around(mesh, SIDE), len(mesh.vertices)
    vertices = lattice.to_unit(mesh.vertices)
    welded = WeldedMesh.of(vertices, mesh.faces.copy())
    of_mesh = welded.edges.edges
    number = np.arange(SIDE**3, dtype=np.int32).reshape(SIDE, SIDE, SIDE)
    points = (np.stack(np.unravel_index(number.ravel(), number.shape), axis=1) + 0.5) / SIDE
    column = np.arange(SIDE * SIDE + 1)
    ends = np.zeros(SIDE * SIDE, np.int32)
    stretches = InteriorPoints(SIDE, column, ends, ends + SIDE - 1, column * SIDE)

    around = np.pad(number, 1, constant_values=-1)
    up = [np.roll(around, -1, axis)[1:-1, 1:-1, 1:-1].ravel() for axis in range(3)]
    inside = [first + np.stack([number.ravel(), to], axis=1)[to >= 0] for to in up]
    cell = np.clip((vertices * SIDE).astype(int), 0, SIDE - 1)
    ties = np.stack([np.arange(first), first + number[tuple(cell.T)]], axis=1)

    nodes = np.concatenate([vertices, points])
    edges = np.concatenate([of_mesh, *inside, ties]).astype(np.int32)
    return CutCellGraph(
        nodes=nodes,
        node_kind=np.repeat(np.array([MESH, INTERIOR], np.uint8), (first, len(points))),
        edges=edges,
        lengths=np.linalg.norm(nodes[edges[:, 0]] - nodes[edges[:, 1]], axis=1),
        edge_kind=(np.arange(len(edges)) >= len(of_mesh)).astype(np.uint8),
        triangle=np.full(len(nodes), -1, np.int32),
        mesh=welded,
        lattice=lattice,
        connectivity=connectivity,
        interior=stretches,
        inverted=np.zeros(len(mesh.faces), bool),
        omitted=np.zeros(len(mesh.faces), np.uint8),
    )
