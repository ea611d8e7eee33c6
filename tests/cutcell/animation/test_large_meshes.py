"""Weights of large meshes come near to the exact solution, on surfaces and on what is none."""

import subprocess
import sys

import numpy as np
import pytest

import cutcell
from cutcell import Rig, TriangleMesh
from cutcell.animation.falloff import diffusion
from cutcell.animation.falloff.diffusion import MANY, Diffusion
from cutcell.animation.falloff.surface_operators import SurfaceOperators
from cutcell.geodesics.distances import bone_distances
from tests.bars import grid_box
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


def spread(points, faces):
    """Spread the weights of three joints, with steps between them."""
    surface = SurfaceOperators.over(points, np.asarray(faces, np.int32))
    known = np.eye(3)[np.clip(points[:, 0] * 3, 0, 2).astype(int)]
    diffused = Diffusion.over(surface, np.full(len(points), DEPTH), 64)
    return diffused.spread(known), len(diffused.levels)


@pytest.mark.parametrize("shape", [lambda: grid(100), soup, needles, noisy, fan, non_manifold])
def test_coarser_meshes_have_nearly_the_exact_weights(shape, monkeypatch):
    exact, levels = spread(*shape())
    assert levels == 0
    monkeypatch.setattr(diffusion, "MANY", 1_500)
    weights, levels = spread(*shape())
    assert weights.min() >= 0
    assert weights.sum(axis=1) == pytest.approx(1)
    assert np.abs(weights - exact).sum(axis=1).mean() < 0.02


def test_a_bar_of_many_vertices_is_bound_nearly_as_exactly(monkeypatch):
    vertices, faces = grid_box(40, 40, 40, size=(1.0, 1.0, 1.0))
    skeleton = cutcell.Skeleton([[0.1, 0.5, 0.5], [0.5, 0.5, 0.5], [0.9, 0.5, 0.5]], [-1, 0, 1])
    rig = Rig(TriangleMesh(vertices, faces), skeleton)
    distances = bone_distances(cutcell.build_graph(rig.mesh, 24), skeleton)
    exact = cutcell.skinning_weights(distances)
    monkeypatch.setattr(diffusion, "MANY", 2_000)
    difference = np.abs(cutcell.skinning_weights(distances) - exact).sum(axis=1)
    assert 0 < difference.mean() < 0.02


def test_progress_can_stop_it():
    def stop(done):
        raise cutcell.Cancelled

    points, faces = grid(230)
    assert len(points) > MANY
    surface = SurfaceOperators.over(points, faces.astype(np.int32))
    diffused = Diffusion.over(surface, np.full(len(points), DEPTH), 64)
    with pytest.raises(cutcell.Cancelled):
        diffused.spread(np.eye(9)[(points[:, 0] * 9).astype(int)], stop)


@pytest.mark.slow
def test_factors_that_another_thread_made_leave_no_memory_behind():
    # In a process of its own: what other tests leave to the allocator is not measured.
    command = [sys.executable, "-m", "tests.cutcell.animation.factors_by_threads"]
    grown = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=True).stdout
    assert int(grown) < 30_000  # kB; it was six times as much
