"""Splitting vertices at seams, against a slow oracle."""

import numpy as np
import pytest
from numpy.testing import assert_array_equal

from cutcell.io.gltf_seams import split_at_seams


def naive_split(faces, count, values):
    """Return corners' numbers, made one by one: where values are new to a vertex it is a copy."""
    known, origin, found = {}, list(range(count)), []
    for vertex, value in zip(
        faces.ravel().tolist(), values.reshape(-1, values.shape[2]), strict=True
    ):
        mine = known.setdefault(vertex, {})
        key = tuple(value.tolist())
        if key not in mine and mine:
            origin.append(vertex)
        found.append(mine.setdefault(key, vertex if not mine else len(origin) - 1))
    return np.reshape(found, faces.shape), np.array(origin)


@pytest.mark.parametrize("different", [1, 2, 50])
@pytest.mark.parametrize("seed", range(5))
def test_it_is_what_a_slow_one_makes(seed, different):
    rng = np.random.default_rng(seed)
    faces = rng.integers(0, 9, (20, 3))
    values = rng.integers(0, different, (20, 3, 2)).astype(np.float32)
    split, origin = split_at_seams(faces, 10, values)
    expected, expected_origin = naive_split(faces, 10, values)
    assert_array_equal(origin[split], faces)
    assert_array_equal(origin[:10], np.arange(10))
    assert len(origin) == len(expected_origin)
    pairs = {*zip(split.ravel().tolist(), expected.ravel().tolist(), strict=True)}
    assert len(pairs) == len({a for a, _ in pairs}) == len({b for _, b in pairs})
    kept = split < 10
    assert_array_equal(kept, expected < 10)


def test_without_seams_nothing_is_split():
    faces = np.array([[0, 1, 2], [2, 1, 3]])
    values = np.arange(4)[faces][..., None].astype(np.float32)
    split, origin = split_at_seams(faces, 5, values)
    assert_array_equal(split, faces)
    assert_array_equal(origin, np.arange(5))
