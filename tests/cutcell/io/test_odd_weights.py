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
    result = builder.json["meshes"][0]["primitives"][0]["attributes"]
    result |= {"JOINTS_0": builder.accessor(joints), "WEIGHTS_0": builder.accessor(shares)}
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
    # Rows that did not change keep their bytes in a glTF document.
    assert bool(again.warnings) == (make is odd_glb)


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


def unequal(rig):
    """Return rows of which two sum to zero, three to a half, and one to one but for rounding."""
    weights = np.array(rig.weights)
    weights[[0, 4]] = 0
    weights[[1, 2, 3]] *= 0.5
    weights[5] *= 1 + 5e-4
    return weights


def glb_sums(path):
    shares = np.zeros((12, 4), "f4")
    shares[:, :2] = unequal(small_rig())
    builder = column()
    attributes = builder.json["meshes"][0]["primitives"][0]["attributes"]
    joints = np.tile(np.array([0, 1, 0, 0], "u1"), (12, 1))
    attributes |= {"JOINTS_0": builder.accessor(joints), "WEIGHTS_0": builder.accessor(shares)}
    return builder.save(path)


def txt_sums(path):
    cutcell.save(path, small_rig())
    lines = [line for line in path.read_text().splitlines() if not line.startswith("skin")]
    for i, row in enumerate(unequal(small_rig())):
        lines.append(f"skin {i} root {row[0]} tip {row[1]}")
    path.write_text("\n".join(lines))
    return path


def npz_sums(path):
    cutcell.save(path, small_rig())
    with np.load(path) as stored:
        arrays = dict(stored)
    weights = unequal(small_rig())
    rows, columns = np.nonzero(weights)
    arrays |= {"skinning_weights_row": rows, "skinning_weights_col": columns}
    np.savez(path, **arrays | {"skinning_weights_value": weights[rows, columns]})
    return path


@pytest.mark.parametrize(
    ("make", "name", "mesh"),
    [
        (glb_sums, "rig.glb", "body"),
        (txt_sums, "rig.txt", "rig"),
        (npz_sums, "rig.npz", "rig"),
    ],
)
def test_rows_that_do_not_sum_to_one_are_counted(tmp_path, make, name, mesh):
    rig = cutcell.load(make(tmp_path / name))
    empty, off = rig.warnings
    assert empty.startswith("2 of 12")
    assert f"{mesh}: 2" in empty
    assert off.startswith("3 of 12")
    assert f"{mesh}: 3" in off
    sums = rig.weights.sum(axis=1)
    assert_allclose(sums, np.where(np.isin(np.arange(12), [0, 4]), 0, 1))
