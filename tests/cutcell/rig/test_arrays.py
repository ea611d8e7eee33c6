"""Whatever is given as an array becomes one, or a sentence says why not."""

import numpy as np
import pytest

from cutcell import MeshError
from cutcell.rig.checks import as_array

PAIRS = (None, 2)


@pytest.mark.parametrize(
    "value",
    [
        [[1, 2]],
        ((1.0, 2.0),),
        np.array([[1, 2]], np.uint8),
        np.array([[1, 2]], object),
        np.array([[1], [2]], np.float32).T,
    ],
)
@pytest.mark.parametrize("dtype", [np.int64, np.float64])
def test_numbers_of_any_kind_are_copied(value, dtype):
    array = as_array(value, dtype, PAIRS, "pairs", MeshError)
    assert array.dtype == dtype
    np.testing.assert_array_equal(array, [[1, 2]])
    assert not np.shares_memory(array, np.asarray(value))


@pytest.mark.parametrize("value", [[], [[]], np.zeros((0, 7))])
def test_nothing_has_any_shape_where_nothing_is_expected(value):
    assert as_array(value, np.float64, PAIRS, "pairs", MeshError).shape == (0, 2)
    assert as_array(value, np.bool_, (0,), "flags", MeshError).shape == (0,)


@pytest.mark.parametrize(
    ("value", "dtype", "shape", "sentence"),
    [
        ([[1 + 0j, 2]], np.float64, PAIRS, "an array of real numbers, not of complex128"),
        ([["1", "2"]], np.float64, PAIRS, "an array of real numbers, not of <U1"),
        (np.array([[1j, 2]], object), np.float64, PAIRS, "must be an array of numbers"),
        (None, np.float64, PAIRS, r"has the shape \(\)"),
        ([[1, 2], [3]], np.float64, PAIRS, "must be an array of numbers"),
        ([[1, 10**400]], np.float64, PAIRS, "must be an array of numbers"),
        ([[1, 10**30]], np.int64, PAIRS, "must be an array of numbers"),
        ([[1, np.nan]], np.int64, PAIRS, "must be whole numbers"),
        ([[1, 1e300]], np.int64, PAIRS, "must be whole numbers"),
        ([1, 2], np.float64, PAIRS, r"has the shape \(2,\), expected \(any, 2\)"),
        ([], np.float64, (3,), r"has the shape \(0,\), expected \(3,\)"),
        ([1, 2], np.bool_, (2,), "must be True or False each"),
        ([1, np.nan], np.bool_, (2,), "must be True or False each"),
    ],
)
def test_says_what_is_wrong(value, dtype, shape, sentence):
    with pytest.raises(MeshError, match=sentence) as caught:
        as_array(value, dtype, shape, "given", MeshError)
    assert str(caught.value).startswith("given ")
    assert "\n" not in str(caught.value)
