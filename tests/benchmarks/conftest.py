"""What the tests of the scripts share."""

import numpy as np
import pytest

import cutcell
from tests.bars import bar


@pytest.fixture
def small(tmp_path):
    """Save a bar that two joints of three hold: no character, but measured in a moment."""
    rig = bar(6)
    far = rig.mesh.vertices[:, :1] > 0.5
    path = tmp_path / "bar.glb"
    cutcell.save(path, rig.with_weights(np.hstack([~far, far, 0 * far]).astype(float)))
    return str(path)
