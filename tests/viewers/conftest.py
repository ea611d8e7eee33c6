"""The arm and its binding, which no test changes."""

import pytest

import cutcell
from cutcell.binding import Binding
from cutcell.rig import Rig
from tests.viewers.arm import arm_rig


@pytest.fixture(scope="session")
def rig() -> Rig:
    """Make the arm; its arrays are frozen."""
    return arm_rig()


@pytest.fixture(scope="session")
def binding(rig: Rig) -> Binding:
    """Bind the arm at the resolution of most tests."""
    result = cutcell.bind(rig, 16)
    result.weights.setflags(write=False)
    return result
