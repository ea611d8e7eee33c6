"""Weights stay where a character is the same in every way that counts."""

import pytest

import cutcell
from benchmarks.stability import ALLOWED, change

pytestmark = pytest.mark.slow


@pytest.mark.parametrize("name", ["khronos_Fox", "khronos_RiggedFigure", "quaternius_trex"])
def test_noise_order_turns_and_welding_change_nothing(rigs, name):
    rig = cutcell.load(next(path for path in rigs if path.stem == name))
    changes = change(rig, 32)
    assert {variant: part for variant, (part, _) in changes.items() if part > ALLOWED} == {}
