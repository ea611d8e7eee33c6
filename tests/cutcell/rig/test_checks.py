"""Checks of parameters take numbers of any type, and say what is wrong with anything else."""

import numpy as np
import pytest

from cutcell import MeshError, ParameterError
from cutcell.checks import MAX_SHOWN, check_choice, check_flag, check_integer, check_number, shown
from cutcell.rig.checks import check_positions

STRANGE = [None, "5", b"5", 3 + 4j, [], [5], {}, object(), np.array([5]), np.datetime64("NaT", "s")]
"""No number, though numpy would take some for one."""
WIDE = [np.nan, np.inf, -np.inf, 10**400, -(10**5000), 1e308, True]


@pytest.mark.parametrize("value", [5, 5.0, np.int8(5), np.uint64(5), np.float32(5)])
def test_numbers_of_any_type_are_taken(value):
    integer, number = check_integer("n", value, 0, 9), check_number("x", value, 0, 9)
    assert (type(integer), type(number)) == (int, float)
    assert integer == number == 5
    assert type(check_choice("c", value, (5, "any"))) is int


@pytest.mark.parametrize("value", [*STRANGE, *WIDE, -1], ids=lambda value: type(value).__name__)
def test_anything_else_is_no_number(value):
    for check in (check_integer, check_number):
        with pytest.raises(ParameterError, match=r"^n must be a (whole )?number from 0 to 9, not "):
            check("n", value, 0, 9)


def test_whole_numbers_have_no_fraction():
    with pytest.raises(
        ParameterError, match=r"n must be a whole number from 0 to 9, not 1\.5; why"
    ):
        check_integer("n", 1.5, 0, 9, "why")


@pytest.mark.parametrize("value", STRANGE[1:], ids=lambda value: type(value).__name__)
def test_choices_are_listed(value):
    with pytest.raises(ParameterError, match="c must be one of None, 6, 'any', not "):
        check_choice("c", value, (None, 6, "any"))


def test_flags_are_true_or_false():
    assert check_flag("f", True) is check_flag("f", np.True_) is True
    for value in (0, 1.0, *STRANGE):
        with pytest.raises(ParameterError, match="f must be True or False, not "):
            check_flag("f", value)


class Broken:
    def __repr__(self):
        raise RuntimeError


def test_wrong_values_are_shown_on_one_short_line():
    assert shown("many") == "'many'"
    assert shown(np.zeros((9, 9))).endswith("...")
    assert len(shown("x" * 10_000)) == MAX_SHOWN
    assert shown(10**5000) == "something of the type int"
    assert shown(Broken()) == "something of the type Broken"


def test_positions_too_far_out_are_named():
    points = np.zeros((3, 3))
    check_positions(points, "vertex", MeshError)
    points[1] = 0, -1e61, 0
    with pytest.raises(MeshError, match=r"vertex 1 lies at \(0, -1e\+61, 0\), .* 1 of 3 are so"):
        check_positions(points, "vertex", MeshError)
