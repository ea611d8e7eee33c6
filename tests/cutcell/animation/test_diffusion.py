"""The diffusion solves its equation where weights are not negligible, on whatever surface."""

import numpy as np
import pytest
from scipy.sparse import csc_array, csr_array
from scipy.sparse.linalg import spsolve

import cutcell
from cutcell.animation.falloff import diffusion
from cutcell.animation.falloff.diffusion import NEGLIGIBLE_WEIGHT, Diffusion
from cutcell.animation.falloff.dissection import MIN_PART, dissect
from cutcell.animation.falloff.surface_operators import SurfaceOperators
from tests import meshes
from tests.conftest import ROOT

DEPTH = 0.05
"""Of all vertices of these meshes in the unit cube: how far from the bones they are."""


def grid(side):
    """Return a wavy square of side² vertices."""
    x, y = (a.ravel() / side for a in np.mgrid[:side, :side])
    points = np.stack([x, y, 0.5 + 0.05 * np.sin(20 * x) * np.cos(15 * y)], axis=1)
    v = np.arange(side * side).reshape(side, side)
    a, b, c, d = v[:-1, :-1].ravel(), v[1:, :-1].ravel(), v[1:, 1:].ravel(), v[:-1, 1:].ravel()
    return points, np.concatenate([np.stack([a, b, c], 1), np.stack([a, c, d], 1)])


def soup():
    """Return triangles of all sizes, each for itself."""
    rng = np.random.default_rng(2)
    size = 10 ** rng.uniform(-6, -1, (5_000, 1, 1))
    corners = rng.random((5_000, 1, 3)) + size * rng.normal(size=(5_000, 3, 3))
    return corners.reshape(-1, 3), np.arange(15_000).reshape(-1, 3)


def needles():
    """Return a square that is squeezed to a hundred-thousandth along one side."""
    points, faces = grid(100)
    return points * [1, 1e-5, 1], faces


def noisy():
    """Return a square whose vertices have been moved about, so that many faces are folded over."""
    points, faces = grid(100)
    return points + np.random.default_rng(3).normal(size=points.shape) * 0.01, faces


def fan():
    """Return a disc of very many triangles around one vertex."""
    turn = np.linspace(0, 2 * np.pi, 9_000, endpoint=False)
    rim = 0.5 + 0.4 * np.stack([np.cos(turn), np.sin(turn), 0 * turn], axis=1)
    v = np.arange(1, 9_001)
    faces = np.stack([np.zeros_like(v), v, np.roll(v, -1)], axis=1)
    return np.concatenate([[[0.5, 0.5, 0.5]], rim]), faces


def non_manifold():
    """Return squares that share an edge, faces given twice, and vertices of no face."""
    points, faces = grid(70)
    other = faces + len(points)
    other[other % len(points) < 70] -= len(points)  # the first row is that of the first square
    stray = np.random.default_rng(4).random((2_000, 3))
    points = np.concatenate([points, points[:, [0, 2, 1]], stray])
    return points, np.concatenate([faces, other, faces[:2_000]])


SHAPES = [lambda: grid(100), soup, needles, noisy, fan, non_manifold]


def diffused(points, faces):
    """Return shares of three joints, with steps between them, and the diffusion of a surface."""
    surface = SurfaceOperators.over(points, np.asarray(faces, np.int32))
    shares = csr_array(np.eye(3)[np.clip(points[:, 0] * 3, 0, 2).astype(int)])
    return shares, surface, Diffusion.over(surface, np.full(len(points), DEPTH), 64)


@pytest.mark.parametrize("shape", SHAPES)
def test_it_is_what_a_general_solver_finds(shape):
    shares, surface, of_surface = diffused(*shape())
    start, column, value = surface.stiffness
    matrix = csr_array((value.copy(), column, start), (len(of_surface.screening),) * 2)
    matrix.data[start[:-1]] += of_surface.screening
    right = of_surface.screening[:, None] * shares.toarray()
    expected = np.maximum(spsolve(csc_array(matrix), right), 0)
    expected /= expected.sum(axis=1, keepdims=True)
    result = of_surface.spread(shares).toarray()
    np.testing.assert_allclose(result, expected, atol=10 * NEGLIGIBLE_WEIGHT)
    assert result.sum(axis=1) == pytest.approx(1)
    assert result.min() >= 0


@pytest.mark.parametrize("shape", SHAPES)
def test_blocks_divide_the_vertices_and_their_borders_hold_all_other_neighbours(shape):
    points, faces = shape()
    start, column, _ = SurfaceOperators.over(points, np.asarray(faces, np.int32)).stiffness
    blocks = dissect(start, column)
    count = len(points)
    np.testing.assert_array_equal(np.sort(blocks.vertex), np.arange(count))
    np.testing.assert_array_equal(blocks.vertex[blocks.position], np.arange(count))
    assert blocks.begin[0] == 0
    assert blocks.begin[-1] == count
    assert (np.diff(blocks.begin) > 0).all()
    assert (blocks.parent > np.arange(len(blocks.parent))).all()
    block = np.repeat(np.arange(len(blocks.parent)), np.diff(blocks.begin))
    borders = np.split(blocks.border, blocks.border_begin[1:-1])
    row, other = np.repeat(blocks.position, np.diff(start)), blocks.position[column]
    is_later = block[other] > block[row]
    for t, border in enumerate(borders):
        assert (np.diff(border) > 0).all()
        neighbours = set(other[is_later & (block[row] == t)].tolist())
        children = np.flatnonzero(blocks.parent == t)
        of_children = {k for c in children for k in borders[c].tolist() if block[k] != t}
        assert set(border.tolist()) == neighbours | of_children
    # A surface has short separators, so that most of it is in small blocks.
    if shape is SHAPES[0]:
        assert np.diff(blocks.begin).max() < 3 * np.sqrt(count)
        assert len(blocks.parent) > count / MIN_PART / 2


def test_weights_on_their_support_are_those_on_all_vertices(monkeypatch):
    rig = cutcell.load(ROOT / "assets" / "biped_cape.glb")
    distances = cutcell.bone_distances(cutcell.build_graph(rig.mesh, 24), rig.skeleton)
    result = cutcell.skinning_weights(distances)
    monkeypatch.setattr(diffusion, "NEGLIGIBLE_WEIGHT", 0.0)
    monkeypatch.setattr(diffusion, "MIN_SHARE", 0.0)
    np.testing.assert_allclose(result, cutcell.skinning_weights(distances), atol=1e-6)


def test_it_is_linear():
    shares, _, of_surface = diffused(*meshes.ball(3))
    halves = [csr_array(shares.toarray() * (np.arange(3) == j)) for j in range(3)]
    parts = [of_surface.equilibrium(half).toarray() for half in halves]
    expected = of_surface.equilibrium(shares).toarray()
    np.testing.assert_allclose(sum(parts), expected, atol=10 * NEGLIGIBLE_WEIGHT)
    nothing = of_surface.equilibrium(csr_array(shares.shape))
    assert nothing.shape == shares.shape
    assert not nothing.nnz


def test_progress_can_stop_it():
    def stop(done):
        raise cutcell.Cancelled

    shares, _, of_surface = diffused(*grid(100))
    with pytest.raises(cutcell.Cancelled):
        of_surface.spread(shares, stop)
