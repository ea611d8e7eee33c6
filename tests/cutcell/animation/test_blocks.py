"""Blocks of lattice points deep inside."""

import numpy as np
import pytest

from cutcell import TriangleMesh
from cutcell.animation.any_angle.contraction import contract, find_blocks
from cutcell.graph import build_graph
from tests import meshes


def blocks_of(mesh, resolution):
    """Return the lattice places of all points, whether each is deep, and each one's block."""
    graph = build_graph(TriangleMesh(*mesh), resolution, connectivity="any")
    nodes = graph.nodes[graph.first_point : graph.first_surface]
    place = (nodes * resolution).astype(int)
    steps = contract(graph).steps
    return place, (steps >= 0).all(axis=1), find_blocks(nodes, resolution, steps)


@pytest.mark.parametrize("resolution", [29, 30])
@pytest.mark.parametrize("name", ["ball", "torus", "flipped"])
def test_a_block_is_eight_deep_points_laid_out_from_the_middle(name, resolution):
    place, deep, block = blocks_of(meshes.ALL[name](), resolution)
    # In half cells from the middle, pairs are 1, 3 | 5, 7 | .. or else 2, 4 | 6, 8 | ..
    away = 2 * place + 1 - resolution
    side = np.where(away >= 0, 1, -1)
    pair = (np.abs(away) - (1 if resolution % 2 == 0 else 2)) // 4
    expected = np.full(len(place), -1)
    cells = np.concatenate([side, pair], axis=1)
    for cell in np.unique(cells[deep], axis=0):
        own = np.flatnonzero((cells == cell).all(axis=1) & deep)
        if len(own) == 8 and (cell[3:] >= 0).all():
            expected[own] = own[np.abs(away[own]).sum(axis=1).argmin()]
    assert (expected >= 0).sum() >= 8
    np.testing.assert_array_equal(block, expected)


def test_a_body_as_its_own_mirror_image_has_mirrored_blocks():
    vertices, faces = meshes.ball(2)
    place, _, block = blocks_of((vertices, faces), 24)
    innermost = {tuple(place[p]) for p in np.unique(block[block >= 0])}
    assert len(innermost) > 50
    assert innermost == {(23 - x, y, z) for x, y, z in innermost}
