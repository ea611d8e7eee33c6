"""Weights that are no numbers count as none, and that is told."""

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

import cutcell
from cutcell.io.weights import normalised, summed
from tests.cutcell.io.gltf.gltf_builder import JOINTS, SHARES, column
from tests.cutcell.io.gltf.test_gltf_fresh import small_rig

ODD = {"nan": np.nan, "negative": -0.25, "infinite": np.inf}
TWO = "2 of 12 vertices have weights that are negative or not a number; these weights count as none"


def odd_glb(path, value):
    """Write the column with an odd weight at vertices 3 and 5, and a wrong joint under it."""
    shares, joints = SHARES.copy(), JOINTS.copy()
    shares[[3, 5], 2], joints[3, 2] = value, 9
    builder = column()
    found = builder.json["meshes"][0]["primitives"][0]["attributes"]
    found |= {"JOINTS_0": builder.accessor(joints), "WEIGHTS_0": builder.accessor(shares)}
    return builder.save(path)


def odd_txt(path, value):
    cutcell.save(path, small_rig())
    lines = path.read_text().splitlines()
    odd = ("skin 3 ", "skin 5 ")
    path.write_text("\n".join(s + f" tip {value}" * s.startswith(odd) for s in lines))
    return path


def odd_npz(path, value):
    cutcell.save(path, small_rig())
    with np.load(path) as stored:
        arrays = dict(stored)
    for name, more in (("value", [value] * 2), ("row", [3, 5]), ("col", [1, 1])):
        key = f"skinning_weights_{name}"
        arrays[key] = np.concatenate([arrays[key], more])
    np.savez(path, **arrays)
    return path


@pytest.mark.parametrize("value", ODD.values(), ids=ODD)
@pytest.mark.parametrize(
    ("make", "name", "owner"),
    [
        (odd_glb, "rig.glb", 'mesh "column", primitive 0'),
        (odd_txt, "rig.txt", 'mesh "rig"'),
        (odd_npz, "rig.npz", 'mesh "rig"'),
    ],
)
def test_odd_weights_count_as_none_and_are_told(tmp_path, make, name, owner, value):
    rig = cutcell.load(make(tmp_path / name, value))
    assert_allclose(rig.weights, SHARES[:, :2])
    assert rig.warnings == (f"{owner}: {TWO}",)
    assert np.isnan(rig.weight_sums).sum() == 2
    assert rig.with_weights(rig.weights).weight_sums is None
    cutcell.save(tmp_path / "out.glb", rig)
    again = cutcell.load(tmp_path / "out.glb")
    assert_allclose(again.weights, rig.weights, atol=1e-7)
    assert again.warnings == ()


def test_a_vertex_with_nothing_but_odd_weights_has_none():
    rows, columns = np.array([0, 0, 1]), np.array([0, 1, 1])
    weights, warnings, sums = summed(rows, columns, np.array([np.nan, -1, 2]), (2, 2), "it")
    assert_array_equal(weights, [[0, 0], [0, 1]])
    assert warnings[0].startswith("it: 1 of 2 vertices has weights that are negative")
    assert_array_equal(sums, [np.nan, 2])


@pytest.mark.parametrize("most", [1.0, 1e300, 1.7e308])
def test_large_weights_do_not_overflow(tmp_path, most):
    weights = np.array([[most, most], [most, 0], [0, 0], [1e-3, 3e-3]])
    expected = [[0.5, 0.5], [1, 0], [0, 0], [0.25, 0.75]]
    assert_allclose(normalised(weights), expected)
    rows, columns = np.nonzero(np.ones((4, 2)))
    for repeats in (1, 3):
        given = [np.tile(a, repeats) for a in (rows, columns, weights.ravel())]
        assert_allclose(summed(*given, (4, 2), "it")[0], expected)
    rig = small_rig()
    heavy = rig.weights * most
    for name in ("heavy.glb", "heavy.npz", "heavy.txt"):
        cutcell.save(tmp_path / name, rig.with_weights(heavy))
        assert_allclose(cutcell.load(tmp_path / name).weights, rig.weights, atol=1e-7)
