"""Settings that were measured, as rows of a table and as points of curves."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any

from cutcell.method import OPTIONS

from ....document.state import State
from ....looks.measures import MEASURES as DISTANCES
from .choices import MEASURES
from .results import choices_of

WORDS = {
    name: {str(value): title for title, value in option.values.items()}
    for name, option in OPTIONS.items()
    if isinstance(option.values, Mapping)
}
"""Titles of values that are no numbers."""


@dataclass(frozen=True)
class Setting:
    """One setting that was measured, or is going to be.

    Parameters
    ----------
    id : str
        Different for each setting of a sweep.
    title : str
    choices : dict
        The same choices on the page.
    curve : str
        Title of the curve that it is on.
    values : dict of str to float
        By measure; empty where there are none.
    note : str
        Why it failed.
    """

    id: str
    title: str
    choices: dict[str, Any]
    curve: str = ""
    values: dict[str, float | None] = field(default_factory=dict)
    note: str = ""


def settings_of(state: State) -> list[Setting]:
    """Return the settings of the sweep that is chosen, in its order."""
    if state.sweep_of == "distance":
        return [
            Setting(
                f"{one.measure} {one.resolution}",
                f"{DISTANCES[one.measure]}, {one.resolution}",
                {"connectivity": _typed(one.measure), "resolution": one.resolution},
                DISTANCES[one.measure],
                {"error": 100 * one.error, "seconds": one.seconds},
            )
            for one in state.error_curves or ()
        ]
    return [_setting(state, text) for text in state.sweep_texts]


def _typed(connectivity: str) -> int | str:
    return int(connectivity) if connectivity.isdecimal() else connectivity


def _setting(state: State, text: str) -> Setting:
    option, point = state.sweep_option, state.swept.get(text)
    title = WORDS.get(option, {}).get(text, text.capitalize() if option == "orient" else text)
    choices = choices_of(option, text)
    if point is None:
        return Setting(text, title, choices)
    if point.failed:
        return Setting(text, title, choices, note=point.failed)
    values = {name: in_units(name, getattr(point, name)) for name in MEASURES.values()}
    return Setting(text, title, choices, values=values)


def in_units(measure: str, value: float | None) -> float | None:
    """Return a measure in the unit that the page shows: lengths in mm, shares in per cent."""
    if value is None:
        return None
    units: dict[str, Callable[[float], float]] = {
        "deformation": lambda mean_square: 10 * mean_square**0.5,  # from cm²
        "unreachable": lambda share: 100 * share,
    }
    return units.get(measure, float)(value)


def number(value: float | None) -> str:
    """Return a number with three digits."""
    if value is None:
        return "–"
    return f"{value:.0f}" if value >= 99.5 else f"{value:.3g}"


def is_chosen(state: State, setting: Setting) -> bool:
    """Return whether the page shows a setting."""
    return all(getattr(state, name) == value for name, value in setting.choices.items())
