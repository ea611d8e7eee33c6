"""Items by group are those that a stable sort gives."""

import numpy as np

from cutcell.geometry.sorting import sort_by_group


def test_groups_hold_their_items_in_order():
    group = np.random.default_rng(0).integers(-1, 7, 200).astype(np.int32)
    group[group == 3] = 4  # a group of none
    start, order = sort_by_group(group, 7)
    expected = np.argsort(group, kind="stable")
    np.testing.assert_array_equal(order, expected[group[expected] >= 0])
    np.testing.assert_array_equal(np.diff(start), [(group == k).sum() for k in range(7)])


def test_nothing_is_sorted_into_empty_groups():
    start, order = sort_by_group(np.zeros(0, np.int32), 2)
    assert start.tolist() == [0, 0, 0]
    assert len(order) == 0
