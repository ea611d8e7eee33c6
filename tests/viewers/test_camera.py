"""The first view of characters."""

import numpy as np
import pytest

from cutcell_viewers.camera import FRONT, first_direction, framing


@pytest.mark.parametrize(
    ("size", "seen"),
    [
        ((1.0, 1.8, 0.3), 2),  # a person
        ((0.6, 0.9, 1.0), 2),
        ((0.3, 0.8, 2.0), 0),  # a fish
        ((2.0, 0.1, 1.8), 1),  # a butterfly
        ((1.8, 0.1, 2.0), 1),
    ],
)
def test_the_first_view_shows_a_large_side(size, seen):
    x, y, z = size
    toward = np.abs(first_direction(np.array(size)))
    toward = toward / np.linalg.norm(toward)
    areas = np.array([y * z, x * z, x * y])
    visible = areas * toward
    if seen == 2:
        assert first_direction(np.array(size)) == FRONT
    assert visible.sum() > 0.5 * areas.max()
    assert areas[seen] >= 0.4 * areas.max()
    np.testing.assert_allclose(
        framing(np.array([np.zeros(3), size])).focal_point, np.array(size) / 2
    )
