"""Declarations of options, which the command line and the page read."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from .checks import check_choice, check_flag, check_fraction, check_integer, check_number


@dataclass(frozen=True)
class Whole:
    """A whole number in a range; an error ends with a reason for the range."""

    low: int
    high: int
    why: str = ""


@dataclass(frozen=True)
class Share:
    """A number from 0 to 1, or strictly between them."""

    strictly: bool = False


@dataclass(frozen=True)
class Flag:
    """True or False."""


@dataclass(frozen=True)
class Option:
    """Declaration of an option: its values, and its names for people.

    Parameters
    ----------
    values : Whole, Share, Flag, or mapping of str to value
        Its range, or its values by their titles on the page.
    metavar : str
        Placeholder for a value in `--help`; empty for a flag.
    help : str
        Text of `--help`, to which the defaults are added.
    label : str
        Name on the page; empty if the page does not show the option.
    slider : tuple of 3 float, optional
        Least and greatest value on the page's slider, and its step.
    short : str
        Short flag.
    none : str or None
        Word for the value None on the command line, empty if it has none; None if it is no value.
    """

    values: Whole | Share | Flag | Mapping[str, Any]
    metavar: str
    help: str
    label: str = ""
    slider: tuple[float, float, float] | None = None
    short: str = ""
    none: str | None = None

    def check(self, name: str, value: Any) -> Any:
        """Return a value as the option has it, or raise a `ParameterError`."""
        values = self.values
        if value is None and self.none is not None:
            return None
        if isinstance(values, Whole):
            return check_integer(name, value, values.low, values.high, values.why)
        if isinstance(values, Share):
            return (
                check_fraction(name, value) if values.strictly else check_number(name, value, 0, 1)
            )
        if isinstance(values, Flag):
            return check_flag(name, value)
        return check_choice(name, value, tuple(values.values()))
