"""What is written on pictures."""

import numpy as np
import pytest
from PIL import Image

from cutcell_viewers import lettering
from cutcell_viewers.description import Legend
from cutcell_viewers.palette import LIGHT


@pytest.fixture
def written(monkeypatch):
    """Return a list of the texts that are written, shortened where they were too wide."""
    texts, shortened = [], lettering._shortened
    monkeypatch.setattr(
        lettering, "_shortened", lambda *of: texts.append(shortened(*of)) or texts[-1]
    )
    return texts


@pytest.mark.parametrize("height", range(750, 950, 10))
def test_captions_of_narrow_views_are_smaller_and_whole(height, written):
    captions = ("Along voxels, R = 64 · 0.451",) * 4
    picture = np.zeros((height, 1080, 3), np.uint8)
    lettering.write_captions(
        picture, captions, [(x, 0, 270, 700) for x in range(0, 1080, 270)], LIGHT
    )
    assert tuple(written) == captions


@pytest.mark.parametrize("height", range(690, 730, 5))
def test_a_legend_is_as_wide_as_its_title(height, written):
    title = "Each bone's colour, mixed by weight"
    lettering.legend_card(Legend(title), LIGHT, (980, height))
    assert written == [title]


def test_a_legend_takes_the_same_part_of_a_picture_of_any_size():
    legend = Legend("Distance from hand.L", "distance", "0", "1")
    parts = [
        lettering.legend_card(legend, LIGHT, (4 * k, 3 * k)).height / (3 * k)
        for k in (200, 400, 1000)
    ]
    assert max(parts) < 1.08 * min(parts)


def test_a_legend_covers_nothing():
    covered = np.zeros((300, 400), bool)
    card = Image.new("RGBA", (100, 60))
    corners = []
    for _ in range(4):
        x, y = lettering.free_corner(covered, card)
        assert not covered[y : y + 60, x : x + 100].any()
        corners.append((x > 200, y > 150))
        covered[y : y + 60, x : x + 100] = True
    assert corners == [(False, True), (True, True), (False, False), (True, False)]
    assert lettering.free_corner(covered, card) is None
