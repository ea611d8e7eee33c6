"""The prior takes a network's call as it is, and gives equation 1 along the cut-cell graph."""

import inspect
import subprocess
import sys
from concurrent.futures import ProcessPoolExecutor
from dataclasses import fields
from multiprocessing import get_context
from types import SimpleNamespace

import numpy as np
import pytest

import cutcell
from cutcell.errors import CutcellError, ParameterError, SkeletonError
from cutcell.priors import VertexGroupVoxelSkin, voxel_skin
from tests.bars import bar

RIG = bar(joints=4)
CENTRE, HALF = np.array([0.5, 0.1, 0.1]), 0.5
VERTICES, JOINTS = (RIG.mesh.vertices - CENTRE) / HALF, (RIG.skeleton.joints - CENTRE) / HALF
FACES, PARENTS = RIG.mesh.faces, RIG.skeleton.parents
CALL = {"joints": JOINTS, "vertices": VERTICES, "faces": FACES}
GRID = {"grid_coords": np.zeros((5, 3))}


def distances(parents):
    """Return how far all joints are from all vertices, in half longest sides, (j, n)."""
    graph = cutcell.build_graph((VERTICES, FACES), method="paper")
    return 2 * cutcell.bone_distances(graph, (JOINTS, parents), method="paper").joint


@pytest.mark.parametrize("parents", [None, PARENTS])
@pytest.mark.parametrize("alpha", [0.0, 0.5, 1.0])
def test_square_is_equation_1_without_the_diagonal(parents, alpha):
    d = np.maximum(distances(np.full(4, -1) if parents is None else parents), 1e-6)
    plain = 1 / ((1 - alpha) * d + alpha * d**2) ** 2
    prior = voxel_skin(**CALL, alpha=alpha, parents=parents)
    np.testing.assert_allclose(prior, (plain / plain.sum(axis=0)).T, rtol=0, atol=1e-12)


def test_exp_falls_with_the_share_of_the_largest_distance():
    d = distances(np.full(4, -1))
    plain = np.exp(-20 * d / d.max())
    prior = voxel_skin(**CALL, mode="exp")
    np.testing.assert_allclose(prior, (plain / plain.sum(axis=0)).T, rtol=0, atol=1e-12)


@pytest.mark.parametrize(
    "arguments",
    [
        {"grid": 0, **GRID, **CALL, "mode": "square", "voxel_size": 2 / 196},
        {"grid": 64, **GRID, **CALL, "alpha": 0.5, "link_dis": 1e-5, "grid_query": 27,
         "vertex_query": 27, "grid_weight": 3.0, "mode": "square"},
        CALL,
    ],
)  # fmt: skip
def test_calls_of_networks_are_taken_unchanged(arguments):
    np.testing.assert_array_equal(voxel_skin(**arguments), voxel_skin(**CALL))


def test_arguments_have_the_names_and_the_order_of_the_original():
    names = list(inspect.signature(voxel_skin).parameters)
    assert names[:13] == [
        "grid", "grid_coords", "joints", "vertices", "faces", "alpha", "link_dis", "grid_query",
        "vertex_query", "grid_weight", "voxel_size", "mode", "parents",
    ]  # fmt: skip
    group = [one.name for one in fields(VertexGroupVoxelSkin)]
    assert group[:7] == [
        "grid", "alpha", "link_dis", "grid_query", "vertex_query", "grid_weight", "mode"
    ]  # fmt: skip


@pytest.mark.parametrize("kind", [np.float16, np.float32, np.float64])
def test_precision_follows_the_input(kind):
    prior = voxel_skin(joints=JOINTS.astype(kind), vertices=VERTICES.astype(kind), faces=FACES)
    assert prior.dtype == (np.float64 if kind is np.float64 else np.float32)
    np.testing.assert_allclose(prior.sum(axis=1), 1, atol=1e-6)
    np.testing.assert_allclose(prior, voxel_skin(**CALL), atol=0.02 if kind is np.float16 else 1e-5)


def test_a_root_may_have_no_parent():
    parents = [None, *PARENTS[1:]]
    np.testing.assert_array_equal(
        voxel_skin(**CALL, parents=parents), voxel_skin(**CALL, parents=PARENTS)
    )


def test_loose_vertices_have_finite_weights():
    vertices = np.concatenate([VERTICES, [[0.3, 0.9, 0.0]]])
    for mode in ("square", "exp"):
        prior = voxel_skin(joints=JOINTS, vertices=vertices, faces=FACES, mode=mode)
        assert np.isfinite(prior).all()
        assert prior[-1].sum() == pytest.approx(1)


def test_a_vertex_group_normalises_and_takes_a_configuration():
    asset = SimpleNamespace(vertices=RIG.mesh.vertices, faces=FACES, joints=RIG.skeleton.joints)
    group = VertexGroupVoxelSkin.parse(grid=64, alpha=0.3, mode="exp", backend="pyrender")
    expected = voxel_skin(**CALL, alpha=0.3, mode="exp")
    np.testing.assert_allclose(group.get_vertex_group(asset)["voxel_skin"], expected, atol=1e-9)
    asset.parents = [None, *PARENTS[1:]]
    bones = VertexGroupVoxelSkin.parse(bones=True).get_vertex_group(asset)["voxel_skin"]
    np.testing.assert_allclose(bones, voxel_skin(**CALL, parents=PARENTS), atol=1e-9)
    with pytest.raises(ParameterError, match="joints"):
        group.get_vertex_group(SimpleNamespace(vertices=VERTICES, faces=FACES, joints=None))


@pytest.mark.parametrize(
    ("wrong", "error"),
    [
        ({"mode": "linear"}, ParameterError),
        ({"alpha": 2}, ParameterError),
        ({"joints": JOINTS * np.nan}, SkeletonError),
        ({"faces": FACES + 10_000}, CutcellError),
        ({"parents": [1, 0, 0, 0]}, SkeletonError),
    ],
)
def test_wrong_arguments_are_named(wrong, error):
    with pytest.raises(error):
        voxel_skin(**{**CALL, **wrong})


def of_cache(folder):
    return voxel_skin(**CALL, cache=folder)


def test_a_cache_serves_no_other_arguments_and_no_damaged_file(tmp_path):
    first = of_cache(tmp_path)
    (path,) = tmp_path.glob("*.npy")
    np.save(path, first / 2)
    np.testing.assert_array_equal(of_cache(tmp_path), first / 2)  # it is read
    for other in ({"alpha": 0.1}, {"mode": "exp"}, {"parents": PARENTS}, {"method": "animation"}):
        expected = voxel_skin(**CALL, **other)
        np.testing.assert_array_equal(voxel_skin(**CALL, **other, cache=tmp_path), expected)
    for damage in (b"", path.read_bytes()[:-9], b"no array"):
        path.write_bytes(damage)
        np.testing.assert_array_equal(of_cache(tmp_path), first)


@pytest.mark.slow
def test_processes_share_a_cache(tmp_path):
    with ProcessPoolExecutor(8, mp_context=get_context("spawn")) as pool:
        results = list(pool.map(of_cache, [tmp_path] * 16))
    for result in results:
        np.testing.assert_array_equal(result, results[0])
    assert len(list(tmp_path.iterdir())) == 1


def test_neither_torch_nor_readers_of_files_are_imported():
    code = (
        "import sys, cutcell.priors\n"
        "print({'torch', 'trimesh', 'open3d', 'igl', 'cutcell.io'} & {*sys.modules})"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True)
    assert done.stdout.strip() == "set()", done.stderr
