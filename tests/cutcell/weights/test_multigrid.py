"""Multigrid comes as near to the exact solution as it says, on surfaces and on what is none."""

import numpy as np
import pytest
from scipy.sparse import csr_array

import cutcell
from cutcell import Rig, TriangleMesh
from cutcell.geodesics.distances import bone_distances
from cutcell.weights.rig_falloff import diffusion
from cutcell.weights.rig_falloff.diffusion import SHARPNESS, Diffusion
from cutcell.weights.rig_falloff.multigrid import (
    COARSEST,
    MANY,
    RIGHT_SIDES,
    Multigrid,
    factorise,
)
from cutcell.weights.rig_falloff.surface_operators import SurfaceOperators
from tests.bars import grid_box

SAME = 1e-3
DEPTH = 0.05
"""Of all vertices of these meshes in the unit cube: how far from the bones they are."""


def equation_of(points, faces):
    """Return the matrix of the screened equation of a mesh in the unit cube, and right sides.

    Each right side pulls to 1 in some places and to 0 in others, with steps between.
    """
    surface = SurfaceOperators.over(points, np.asarray(faces, np.int32))
    screening = SHARPNESS * np.maximum(surface.areas, 1e-12) / DEPTH**2
    start, column, value = surface.stiffness
    value = value.copy()
    value[start[:-1]] += screening
    directions = np.random.default_rng(1).normal(size=(3, RIGHT_SIDES)) * 4
    pulled = np.sin(points @ directions) > 0
    return csr_array((value, column, start), (len(points),) * 2), screening[:, None] * pulled


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
    size = 10 ** rng.uniform(-6, -1, (20_000, 1, 1))
    corners = rng.random((20_000, 1, 3)) + size * rng.normal(size=(20_000, 3, 3))
    return corners.reshape(-1, 3), np.arange(60_000).reshape(-1, 3)


def needles():
    """Return a square that is squeezed to a hundred-thousandth along one side."""
    points, faces = grid(200)
    return points * [1, 1e-5, 1], faces


def noisy():
    """Return a square whose vertices have been moved about, so that many faces are folded over."""
    points, faces = grid(200)
    return points + np.random.default_rng(3).normal(size=points.shape) * 0.01, faces


def fan():
    """Return a disc of very many triangles around one vertex."""
    turn = np.linspace(0, 2 * np.pi, 21_000, endpoint=False)
    rim = 0.5 + 0.4 * np.stack([np.cos(turn), np.sin(turn), 0 * turn], axis=1)
    v = np.arange(1, 21_001)
    faces = np.stack([np.zeros_like(v), v, np.roll(v, -1)], axis=1)
    return np.concatenate([[[0.5, 0.5, 0.5]], rim]), faces


def non_manifold():
    """Return squares that share an edge, faces given twice, and vertices of no face."""
    points, faces = grid(120)
    other = faces + len(points)
    other[other % len(points) < 120] -= len(points)  # the first row is that of the first square
    stray = np.random.default_rng(4).random((5_000, 3))
    points = np.concatenate([points, points[:, [0, 2, 1]], stray])
    return points, np.concatenate([faces, other, faces[:5_000]])


def solution(matrix, right, tell=lambda done: None):
    """Return what multigrid finds, with zeros where it is negligible."""
    found = np.zeros_like(right)
    rows, there = Multigrid.of(matrix).solve(right, tell)
    found[rows] = there
    return found


def test_three_levels_of_a_large_surface_take_few_steps():
    points, faces = grid(450)
    matrix, _ = equation_of(points, faces)
    x, y, _ = points.T
    known = np.stack([(1 + np.sin(k * x + y)) / 2 for k in range(RIGHT_SIDES)], axis=1)
    told = []
    assert len(Multigrid.of(matrix).levels) == 2
    assert np.abs(solution(matrix, matrix @ known, told.append) - known).max() < SAME
    assert len(told) < 15, "on all levels together"


@pytest.mark.parametrize("shape", [soup, needles, noisy, fan, non_manifold])
def test_hard_shapes_are_solved_as_well(shape):
    points, faces = shape()
    assert len(points) > COARSEST
    matrix, right = equation_of(points, faces)
    difference = solution(matrix, right) - factorise(matrix).solve(right)
    assert np.abs(difference).max() < SAME


def test_nothing_to_solve_for_is_zero():
    matrix, right = equation_of(*grid(160))
    assert not solution(matrix, np.zeros_like(right)).any()


def test_progress_can_stop_it():
    def stop(done):
        raise cutcell.Cancelled

    matrix, right = equation_of(*grid(160))
    with pytest.raises(cutcell.Cancelled):
        Multigrid.of(matrix).solve(right, stop)


@pytest.fixture(scope="module")
def bar():
    """Return the distances of a bar of 38,000 vertices from its joints."""
    vertices, faces = grid_box(80, 80, 80, size=(1.0, 1.0, 1.0))
    skeleton = cutcell.Skeleton([[0.1, 0.5, 0.5], [0.5, 0.5, 0.5], [0.9, 0.5, 0.5]], [-1, 0, 1])
    rig = Rig(TriangleMesh(vertices, faces), skeleton)
    return bone_distances(cutcell.build_graph(rig.mesh, 24), skeleton)


def test_weights_are_those_of_the_factors(bar, monkeypatch):
    surface = SurfaceOperators.of(bar.graph)
    assert COARSEST < len(surface.points) <= MANY
    by_factors = cutcell.skinning_weights(bar, surface=surface, threshold=0)
    monkeypatch.setattr(diffusion, "MANY", 0)
    depth = bar.at_welded.min(axis=0)
    assert isinstance(Diffusion.over(surface, depth, 24).solver, Multigrid)
    difference = cutcell.skinning_weights(bar, surface=surface, threshold=0) - by_factors
    assert 0 < np.abs(difference).max() < SAME


def test_many_vertices_are_solved_by_multigrid():
    points, faces = grid(230)
    surface = SurfaceOperators.over(points, faces.astype(np.int32))
    assert len(points) > MANY
    known = np.eye(9)[(points[:, 0] * 9).astype(int)]
    found = Diffusion.over(surface, np.full(len(points), DEPTH), 64).spread(known)
    assert found.min() >= 0
    assert found.sum(axis=1) == pytest.approx(1)
