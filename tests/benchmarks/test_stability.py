"""Weights stay where a character is the same in every way that counts."""

import pytest

import cutcell
from cutcell_lab.benchmarks.stability import ALLOWED, change

pytestmark = pytest.mark.nightly


@pytest.mark.parametrize("name", ["khronos_Fox", "khronos_RiggedFigure", "quaternius_trex"])
def test_noise_order_and_welding_change_nothing(rigs, name):
    """A turn moves a mesh relative to the lattice: its change is only printed by the script."""
    rig = cutcell.load(next(path for path in rigs if path.stem == name))
    changes = change(rig, 32)
    changed = {variant: changes[variant][0] for variant in ("noise", "order", "weld")}
    assert {variant: part for variant, part in changed.items() if part > ALLOWED} == {}
