"""What is written on pictures."""

import numpy as np
import pytest

from cutcell_viewers import lettering
from cutcell_viewers.description import Legend
from cutcell_viewers.palette import LIGHT


@pytest.mark.parametrize("height", range(690, 730, 5))
def test_a_legend_is_as_wide_as_its_title(height, monkeypatch):
    written = []
    shortened = lettering._shortened
    monkeypatch.setattr(
        lettering, "_shortened", lambda *of: written.append(shortened(*of)) or written[-1]
    )
    title = "Each bone's colour, mixed by weight"
    lettering.write_legend(np.full((height, 980, 3), 255, np.uint8), Legend(title), LIGHT)
    assert written == [title]
