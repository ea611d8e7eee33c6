"""Representations of large objects stay short."""

from tests.viewers.arm import arm_rig


def test_a_rig_is_represented_in_a_few_lines_whatever_it_holds():
    rig = arm_rig()
    text = repr(rig)
    assert text.startswith("Rig(")
    assert str(len(rig.mesh.vertices)) in text
    assert len(text) < 800, text
