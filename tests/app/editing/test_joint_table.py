"""Tables of joints: branches paired by names, and rules that a person writes."""

import numpy as np
import pytest

from cutcell import ParameterError, Skeleton
from cutcell_app.editing.compute.joint_table import branch_pairs, read_table, swapped

# Two fingers of three and two joints, the children of the second in another order than the first's.
NAMES = ("hand", "mid_1", "idx_1", "mid_2", "idx_2", "mid_a", "mid_b", "idx_b", "idx_a")
PARENTS = (-1, 0, 0, 1, 2, 3, 3, 4, 4)
HAND = Skeleton(np.arange(27.0).reshape(9, 3), PARENTS, NAMES)
FINGERS = {1: 2, 3: 4, 5: 8, 6: 7}


def test_branches_are_paired_by_names_below_paired_joints():
    assert branch_pairs(HAND, 1, 2) == FINGERS
    assert branch_pairs(HAND, 3, 2) == {3: 2, 5: 4} or branch_pairs(HAND, 3, 2) == {3: 2, 6: 4}
    with pytest.raises(ParameterError, match="of one branch"):
        branch_pairs(HAND, 0, 4)


@pytest.mark.parametrize(
    ("text", "pairs"),
    [
        ("mid_1 -> hand", {1: 0}),
        ("mid_1->hand, idx_1 -> hand;", {1: 0, 2: 0}),
        ("mid_* <-> idx_*", swapped(FINGERS)),
        ("mid_* -> idx_*\nhand <-> mid_1", None),
    ],
)
def test_rules_name_joints_or_patterns(text, pairs):
    if pairs is None:
        with pytest.raises(ParameterError, match='"mid_1" is replaced by both'):
            read_table(text, HAND)
    else:
        assert read_table(text, HAND) == pairs


def test_names_are_also_those_without_a_shared_prefix():
    names = [f"mixamorig:{name}" for name in NAMES]
    skeleton = Skeleton(HAND.joints, PARENTS, names)
    assert read_table("mid_* <-> idx_*", skeleton) == swapped(FINGERS)
    assert read_table("mixamorig:hand -> mid_1", skeleton) == {0: 1}


@pytest.mark.parametrize(
    ("text", "sentence"),
    [
        (" , ", "has no rule"),
        ("hand", "is no rule; write for example"),
        ("hand > mid_1", "is no rule"),
        ("hnd -> mid_1", 'no joint "hnd".*"hand"'),
        ("hand -> md_1", 'no joint "md_1"'),
        ("ring_* -> idx_*", "no joint .ring_.."),
        ("*_* -> idx_*", "one star each"),
    ],
)
def test_a_rule_that_cannot_be_read_is_refused(text, sentence):
    with pytest.raises(ParameterError, match=sentence):
        read_table(text, HAND)
