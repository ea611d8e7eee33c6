"""Weights inside tetrahedra, against libigl, SciPy and closed forms."""

import re
import sys

import igl
import numpy as np
import pytest
from scipy.optimize import approx_fprime, lsq_linear
from scipy.spatial import cKDTree

from cutcell import Rig, Skeleton, TriangleMesh
from cutcell.isolated import __main__ as workers
from cutcell.isolated import run as apart
from cutcell_lab.baselines import METHODS
from cutcell_lab.baselines.volumes import volume
from cutcell_lab.baselines.volumes.volume import _fill as fill
from cutcell_lab.isolated import quasi_harmonic, smooth, tetrahedra
from tests import meshes
from tests.bars import bar, check_weights, grid_box

pytestmark = pytest.mark.slow

HANDLES = np.array([[0.1, 0.1, 0.1], [0.3, 0.1, 0.1], [0.7, 0.1, 0.1], [0.9, 0.1, 0.1]])
COLUMN = np.array([0, 0, 1, 1])


@pytest.fixture(autouse=True)
def _in_a_folder_of_its_own(tmp_path, monkeypatch):
    """Run where fTetWild may leave its files."""
    monkeypatch.chdir(tmp_path)


@pytest.fixture(autouse=True)
def nothing_remembered():
    """Let no test see tetrahedra that another one made."""
    fill.cache_clear()


def filled(nx=6):
    points, faces = grid_box(nx)
    result = tetrahedra.by_tetgen(points, faces, HANDLES)
    return result["nodes"], result["tets"]


def held(nodes):
    fixed, values = smooth.constraints(cKDTree(nodes), HANDLES, COLUMN)
    assert len(fixed) == 4
    return fixed, values


def volume_of(nodes, tets):
    sides = nodes[tets[:, 1:]] - nodes[tets[:, :1]]
    return np.linalg.det(sides) / 6


# Tetrahedra


@pytest.mark.parametrize("make", [tetrahedra.by_tetgen, tetrahedra.by_tetwild])
def test_tetrahedra_fill_a_box(make):
    points, faces = grid_box(6)
    edge = {"edge": 0.1} if make is tetrahedra.by_tetwild else {}
    result = make(points, faces, HANDLES, **edge)
    volume = volume_of(result["nodes"], result["tets"])
    assert (abs(volume) > 0).all()
    assert abs(volume).sum() == pytest.approx(0.04, rel=0.02)
    assert cKDTree(result["nodes"]).query(HANDLES)[0].max() < 0.01
    places = np.einsum("kc,kcx->kx", result["shares"], result["nodes"][result["corners"]])
    np.testing.assert_allclose(places, points, atol=5e-3)
    np.testing.assert_allclose(result["shares"].sum(axis=1), 1)


def test_points_become_nodes_and_the_volume_stays():
    nodes, tets = filled()
    tets = tetrahedra.upright(nodes, tets)
    rng = np.random.default_rng(0)
    points = np.concatenate([rng.random((20, 3)) * [1, 0.2, 0.2], [[2.0, 0, 0]]])
    more, split = tetrahedra.insert(nodes, tets, points)
    assert len(more) == len(nodes) + 20
    assert (volume_of(more, split) > 0).all()
    assert volume_of(more, split).sum() == pytest.approx(volume_of(nodes, tets).sum())
    assert cKDTree(more).query(points[:20])[0].max() < 0.03


def test_places_are_found_in_tetrahedra():
    nodes, tets = filled()
    points = np.random.default_rng(1).random((200, 3)) * [1, 0.2, 0.2]
    corners, shares = tetrahedra.locate(nodes, tets, points)
    np.testing.assert_allclose(np.einsum("kc,kcx->kx", shares, nodes[corners]), points, atol=1e-9)
    corners, shares = tetrahedra.locate(nodes, tets, np.array([[-0.1, 0.1, 0.1]]))
    assert np.linalg.norm(shares[0] @ nodes[corners[0]] - [0, 0.1, 0.1]) < 0.1


def test_what_tetgen_cannot_fill_ftetwild_does():
    """An open box: one square is missing at its end."""
    rig = bar(4)
    rig = Rig(TriangleMesh(rig.mesh.vertices, rig.mesh.faces[1:]), rig.skeleton)
    for name in ("biharmonic", "bbw", "quasi_harmonic"):
        result = METHODS[name](rig)
        check_weights(rig, result)
        assert "TetGen cannot fill the surface" in result.warnings[0]
        assert "fTetWild filled it" in result.warnings[0]
        x = rig.mesh.vertices[:, 0]
        assert result.weights[x < 0.2, 0].min() > 0.8
        assert result.weights[x > 0.8, 1].min() > 0.8


def test_surfaces_that_cannot_be_filled_say_so():
    flat = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [1, 1, 0]])
    mesh = TriangleMesh(flat, np.array([[0, 1, 2], [1, 3, 2]]))
    rig = Rig(mesh, Skeleton([[0.2, 0.5, 0], [0.8, 0.5, 0]], [-1, 0]))
    for name in ("bbw", "biharmonic", "quasi_harmonic"):
        result = METHODS[name](rig)
        assert result.weights is None
        assert "TetGen" in result.failed
        assert "fTetWild" in result.failed
        assert result.seconds["tetrahedra"] > 0


# Smooth weights


def test_biharmonic_weights_equal_libigls():
    nodes, tets = filled()
    result = smooth.unbounded(nodes, tets, HANDLES, COLUMN)["weights"]
    expected = igl.harmonic(nodes, tets, *held(nodes), 2)
    np.testing.assert_allclose(result, expected, atol=1e-6)
    np.testing.assert_allclose(result.sum(axis=1), 1, atol=1e-6)


def test_bounded_weights_equal_scipys_least_squares():
    nodes, tets = filled()
    fixed, values = held(nodes)
    result = smooth.bounded(nodes, tets, HANDLES, COLUMN, 50)["weights"]
    stiffness = igl.cotmatrix(nodes, tets).toarray()
    mass = igl.massmatrix(nodes, tets, igl.MASSMATRIX_TYPE_DEFAULT).diagonal()
    root = stiffness / np.sqrt(mass)[:, None]
    free = np.setdiff1d(np.arange(len(nodes)), fixed)
    for column in range(2):
        right = -root[:, fixed] @ values[:, column]
        best = lsq_linear(root[:, free], right, (0, 1), tol=1e-12)
        np.testing.assert_allclose(result[free, column], best.x, atol=2e-3)
    unbounded = smooth.unbounded(nodes, tets, HANDLES, COLUMN)["weights"]
    assert unbounded.max() > 1.001  # bounds do matter


def test_bounded_weights_on_a_bar_mirror_each_other():
    rig = bar()
    result = METHODS["bbw"](rig).weights
    x = rig.mesh.vertices[:, 0]
    assert result[np.isclose(x, 0.5), 0].mean() == pytest.approx(0.5, abs=0.03)
    means = [result[np.isclose(x, at), 0].mean() for at in np.unique(x)]
    assert (np.diff(means) < 0.02).all()


# Quasi-harmonic weights


def test_without_a_step_quasi_harmonic_weights_are_libigls_harmonic_ones():
    nodes, tets = filled()
    result = quasi_harmonic.quasi_harmonic(nodes, tets, HANDLES, COLUMN, 0)["weights"]
    np.testing.assert_allclose(result, igl.harmonic(nodes, tets, *held(nodes), 1), atol=1e-9)


def test_between_two_held_ends_they_fall_off_evenly():
    nodes, tets = filled(10)
    ends = np.flatnonzero(np.isin(nodes[:, 0], (0, 1)))
    column = nodes[ends, 0].astype(int)
    result = quasi_harmonic.quasi_harmonic(nodes, tets, nodes[ends], column, 0)["weights"]
    np.testing.assert_allclose(result[:, 1], nodes[:, 0], atol=1e-9)


def test_the_slope_of_their_energy_equals_finite_differences():
    nodes, tets = filled(3)
    fixed, values = smooth.constraints(cKDTree(nodes), HANDLES, COLUMN)
    problem = quasi_harmonic.Problem(nodes, tets, fixed, values)
    rng = np.random.default_rng(0)
    factor = np.tile(np.eye(3), (len(tets), 1, 1)) + 0.2 * np.tril(rng.normal(size=(3, 3)))
    slope = problem.evaluate(factor)[2]
    for t in (0, len(tets) // 2, len(tets) - 1):

        def energy(x, t=t):
            changed = factor.copy()
            changed[t][np.tril_indices(3)] = x
            return problem.evaluate(changed)[1]

        at = factor[t][np.tril_indices(3)]
        slow = approx_fprime(at, energy, 1e-6)
        scale = abs(slope).max()
        np.testing.assert_allclose(slope[t][np.tril_indices(3)] / scale, slow / scale, atol=1e-4)
        assert slope[t][0, 2] == 0


def test_they_come_near_to_the_smoothest_weights_and_stay_within_bounds():
    nodes, tets = filled(10)
    result = quasi_harmonic.quasi_harmonic(nodes, tets, HANDLES, COLUMN, 8)
    matrix = smooth.smoothness(nodes, tets)
    best = smooth.unbounded(nodes, tets, HANDLES, COLUMN)["weights"]
    least = (best * (matrix @ best)).sum() / 2
    energy = result["energy"]
    assert least < energy.min() < 0.5 * energy[0]
    weights = result["weights"]
    assert (weights * (matrix @ weights)).sum() / 2 == pytest.approx(energy.min())
    np.testing.assert_allclose(weights.sum(axis=1), 1, atol=1e-9)
    # Tetrahedra may bend the principle a little, as wide angles do with any such weights.
    assert weights.min() > -0.05
    assert weights.max() < 1.05


# Processes of their own


@pytest.mark.parametrize(
    ("code", "words"),
    [
        ("import os, signal; os.kill(os.getpid(), signal.SIGSEGV)", "crashed \\(signal 11\\)"),
        ("import time; time.sleep(60)", "fTetWild took longer than 0.5 seconds"),
        ("raise SystemExit('no space left')", "exit code 1: no space left"),
        ("import sys; sys.exit(3)", "TetGen stopped with exit code 3: it said nothing"),
    ],
)
def test_a_library_that_dies_takes_nothing_along(monkeypatch, code, words):
    monkeypatch.setattr(apart, "COMMAND", (sys.executable, "-c", code))
    result = METHODS["bbw"](bar(4), limit=0.5 if "sleep" in code else 60)
    assert result.weights is None
    assert re.search(words, result.failed)


def test_a_solver_that_dies_is_told_from_a_mesher(monkeypatch):
    code = (
        "import sys, runpy; sys.argv[1].endswith(':bounded') and sys.exit(4); "
        "runpy.run_module('cutcell.isolated', run_name='__main__', alter_sys=True)"
    )
    monkeypatch.setattr(apart, "COMMAND", (sys.executable, "-c", code))
    result = METHODS["bbw"](bar(4))
    assert result.failed == "libigl's solver stopped with exit code 4: it said nothing"
    assert set(result.seconds) == {"tetrahedra", "weights"}


def test_without_a_library_the_result_says_so(monkeypatch):
    monkeypatch.setitem(volume.TASKS, "bbw", "nowhere:none")
    failed = METHODS["bbw"](bar(4)).failed
    assert failed.endswith("nowhere is not installed; try: pip install 'cutcell[copyleft]'")


def test_what_a_task_raises_becomes_words(tmp_path):
    points, faces = meshes.tube()
    np.savez(tmp_path / "job.npz", points=points, faces=faces, handles=HANDLES)
    workers.main(
        "cutcell_lab.isolated.tetrahedra:by_tetgen",
        str(tmp_path / "job.npz"),
        str(tmp_path / "result.npz"),
    )
    assert "TetGen cannot fill" in str(np.load(tmp_path / "result.npz")["failed"])
