"""The scene whose speed on the page is measured stands in both views, and can be changed."""

from itertools import pairwise

import numpy as np
import pytest

from benchmarks.page_subjects import cutcell_subject, material, vtk_subject


@pytest.fixture(scope="module")
def small():
    return material(8, 900)


@pytest.mark.parametrize("side", [cutcell_subject, vtk_subject])
def test_a_subject_changes(side, small):
    subject = side(small)
    assert subject.page() is not None
    for turn in range(2):
        subject.color(turn)
        subject.move(turn)
        subject.pose(turn)
        subject.show_graph(turn == 0)
        subject.play(turn == 0)


def test_each_change_differs_from_the_one_before(small):
    for kind in (small.poses, small.points, small.fields):
        assert all((np.asarray(a) != b).any() for a, b in pairwise(kind))
